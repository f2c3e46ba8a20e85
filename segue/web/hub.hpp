// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/type/value.hpp>
#include <segue/web/robot_link.hpp>

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace segue::web {

/// One version of something that a robot shows.
struct Document {
  std::uint64_t version = 0;  ///< counts from 1
  type::Value value;          ///< null: not known (yet)
  std::string error{};        ///< why `value` is not what is now; empty: it is
  std::string change{};       ///< JSON of change_between() the version before and this; empty: no such change
};

/// A reader of documents.
class Viewer {
 public:
  virtual ~Viewer() = default;
  /// There is a newer version of a document. Called by threads of the hub; must neither block nor call the
  /// hub.
  virtual void on_change(const std::string& document) = 0;
};

/// Turns a robot into documents while somebody looks at them; what nobody looks at is not asked of the robot.
/// The documents: "status", with "tasks" and "connections" as maps; "events", a map of the last events by
/// number; "mission", as of control::RobotService::mission, with "plan" where it is known and "entries" as a
/// map by number, and {"run": 0} where there is none; "units", {"units": those of
/// control::RobotService::units by name}; "task/ID", the report of a task; "port/TASK/PORT",
/// {"type", "time_s", "period_s", "value"}: the newest sample, when it was read (monotonic), and how long
/// after it the next one is read at the soonest. All functions may be called from any thread.
class Hub {
 public:
  /// The time between two questions to the robot.
  struct Periods {
    Duration snapshots = std::chrono::milliseconds(500);  ///< status and tasks; also asked after events
    Duration ports = std::chrono::milliseconds(50);
    /// The limit for each port: samples with many numbers, such as images, are read less often than `ports`
    /// says.
    double scalars_per_second = 2e6;
    Duration silence = std::chrono::seconds(2);  ///< after which a port is opened again
  };
  static constexpr std::size_t kMostEvents = 1000;
  static constexpr std::size_t kMostMissionEntries = 20'000;
  static constexpr std::size_t kMostDocuments = 1000;

  explicit Hub(RobotLink& link);
  Hub(RobotLink& link, Periods periods);
  ~Hub();
  Hub(const Hub&) = delete;
  Hub& operator=(const Hub&) = delete;

  /// From now on the viewer is told of changes of that document. NotFound where there is no such document,
  /// ResourceExhausted where too many are looked at.
  Result<void> subscribe(const std::shared_ptr<Viewer>& viewer, const std::string& document);
  void unsubscribe(const Viewer& viewer, const std::string& document);
  /// Takes the viewer off all documents. To be called before the viewer ends.
  void leave(const Viewer& viewer);
  /// Null where nobody looks at it or nothing is known yet.
  [[nodiscard]] std::shared_ptr<const Document> newest(const std::string& document) const;

 private:
  enum Kind : std::uint8_t { kSnapshots, kPorts, kEvents };
  struct Watched;

  void run(Kind kind);
  std::vector<std::shared_ptr<Watched>> watched(Kind kind) const SEGUE_REQUIRES(mutex_);
  void refresh(Watched& document);
  /// The robot's answer; nothing: the document is up to date.
  using Answer = Result<std::optional<type::Value>>;
  [[nodiscard]] bool is_known(const Watched& document) const;
  Answer ask(Watched& document, const RobotLink::Connected& link);
  Answer read_port(Watched& document, const RobotLink::Connected& link);
  Answer follow_mission(Watched& document, const RobotLink::Connected& link);
  Answer follow_events(Watched& document, const RobotLink::Connected& link);
  void publish(Watched& document, type::Value value, std::string error);

  RobotLink& link_;
  const Periods periods_;
  mutable Mutex mutex_;  ///< protects all below but the threads
  ConditionVariable changed_;
  bool ends_ SEGUE_GUARDED_BY(mutex_) = false;
  /// Counts the reasons to ask before the period is over, since a document may be outdated.
  std::uint64_t nudges_ SEGUE_GUARDED_BY(mutex_) = 0;
  std::map<std::string, std::shared_ptr<Watched>> documents_ SEGUE_GUARDED_BY(mutex_);
  std::array<std::thread, 3> threads_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::web
