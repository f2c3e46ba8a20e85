// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/question.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/commanded_robot.hpp>
#include <segue/mission/footprint.hpp>
#include <segue/mission/mission.hpp>
#include <segue/mission/world.hpp>
#include <segue/mission_robot/change_watch.hpp>
#include <segue/mission_robot/robot_poll.hpp>
#include <segue/mission_robot/watched_ports.hpp>
#include <segue/mission_robot/watched_tasks.hpp>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace segue::mission {

/// The robot as a mission observes it: the units of resources, by their names.
struct ShownUnits {
  std::map<std::string, std::uint32_t, std::less<>> units;  ///< kAllUnits: all that there are
  /// Why the mission does not command the robot any more; empty: it does.
  std::string lost;
  friend bool operator==(const ShownUnits&, const ShownUnits&) = default;
};

/// The observed facts (ObservedFact) and units (Resource::observe) of a mission, as the robot shows them.
/// Thread safe.
class FactObserver {
 public:
  /// How often the robot is looked at, and how long its answers may take.
  struct Options {
    /// How often a task is asked that cannot be seen, and an operation whose task is not updated. All else is
    /// looked at when the robot says that it has changed.
    Duration period = std::chrono::milliseconds(20);
    Duration answer_deadline = std::chrono::seconds(1);
    /// Called where the robot cannot be reached any more while units are watched; see
    /// ControllerOptions::unreachable.
    std::function<void(const Error& why)> unreachable{};
  };
  /// Observes what the mission says. Starts a thread.
  FactObserver(std::shared_ptr<CommandedRobot> robot, const Mission& mission, Options options);
  /// Watchers are not called any more.
  ~FactObserver();
  FactObserver(const FactObserver&) = delete;
  FactObserver& operator=(const FactObserver&) = delete;

  /// Begins a run with these facts: they count for facts that could not be observed yet.
  void begin(const World::Facts& facts);
  /// Looks at the robot now: the first of these facts that does not hold as declared. Blocks until the robot
  /// has answered; where a port has just been opened, until its first sample comes, for the fact's settling
  /// time at most.
  std::optional<GroundFact> first_false(std::span<const GroundFact> facts);
  /// Whether the fact holds, as of a poll now; nothing where it cannot be observed.
  std::optional<bool> observed(std::string_view fact);
  /// An action has made these facts true or false: that counts for those that cannot be observed.
  void assume(std::span<const GroundFact> effects);
  /// How long an effect on that fact may take to show.
  [[nodiscard]] Duration settle(std::string_view fact) const;

  /// Says when it is to be called again at the latest; nothing: never again.
  using Poll = std::function<std::optional<TimePoint>()>;
  /// Calls `poll` on the thread of this: soon, whenever a fact may have changed, at the time that it has
  /// said, and when the bell is rung.
  void watch(Poll poll);
  [[nodiscard]] const std::shared_ptr<Bell>& bell() const { return bell_; }

  /// The names of the observed resources.
  [[nodiscard]] std::vector<std::string> resources() const;
  /// Calls `changed` on the thread of this, soon, and whenever the robot shows other units than it was called
  /// with last, until the last copy of what this returns is gone. Units of which nothing can be observed are
  /// not shown.
  [[nodiscard]] std::shared_ptr<void> watch_units(std::function<void(const ShownUnits&)> changed);

 private:
  /// A fact or a resource.
  struct Entry {
    ObservedUnits when;  ///< of a fact: a condition
    Duration settle{};
    std::uint32_t value = 0;  ///< as observed last: units; of a fact 0, or another number where it holds
    bool seen = false;        ///< it could be observed at least once
    std::optional<PortFeed> feed{};
    TimePoint opened{};    ///< `feed`
    TimePoint followed{};  ///< `opened` when it was followed last
    std::uint64_t updates =
        0;  ///< of the task whose port is followed; fewer are those of another incarnation
  };

  void work(const std::stop_token& end);
  void follow_tasks();
  void follow_ports();
  void follow_port(Entry& entry, const Member& port);
  [[nodiscard]] ShownUnits shown_units();
  [[nodiscard]] std::string why_lost();
  /// Calls the watchers; the time by which they are to be called again, nothing: nobody watches.
  std::optional<TimePoint> call_watchers();
  std::optional<std::uint32_t> poll(Entry& entry);
  std::optional<std::uint32_t> poll(Entry& entry, const RobotCondition& when);
  std::optional<std::uint32_t> poll(Entry& entry, const SampleCounts& when);
  std::optional<bool> look(Entry& entry, const TaskReaches& when);
  std::optional<bool> look(Entry& entry, const SampleShows& when);
  std::optional<bool> look(Entry& entry, const OperationAnswers& when);
  const type::Value* last_sample(Entry& entry, const Member& port);
  bool value_now(Entry& entry);

  const std::shared_ptr<CommandedRobot> robot_;
  const Options options_;
  /// Protects what is known of facts and units, but not which ones there are and what is declared of them,
  /// which never changes; held while the robot is asked.
  Mutex polling_;
  std::map<std::string, Entry, std::less<>> facts_;
  std::map<std::string, Entry, std::less<>> resources_;
  std::vector<Entry*> entries_;  ///< all of both
  Mutex mutex_;                  ///< protects `watches_`
  std::vector<Poll> watches_ SEGUE_GUARDED_BY(mutex_);

  // Used by the thread only. Their answers ring the bell; what is so then is asked anew.
  const std::shared_ptr<Bell> bell_ = std::make_shared<Bell>();
  WatchedTasks tasks_;       ///< that show facts; asked for while somebody watches
  WatchedTasks port_tasks_;  ///< whose ports show facts
  WatchedPorts ports_{bell_};
  ChangeWatch changes_;  ///< of who commands the robot; asked for while units are watched
  std::uint32_t unit_watches_ = 0;
  std::string lost_;
  std::stop_token end_;
  std::jthread thread_;
};

}  // namespace segue::mission
