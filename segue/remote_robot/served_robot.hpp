// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/control/robot_service.hpp>
#include <segue/mission/commanded_robot.hpp>
#include <segue/mission/unit_keeper.hpp>
#include <segue/remote_robot/mission_record.hpp>
#include <segue/remote_robot/unit_record.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

/// Robots as missions command them.
namespace segue::remote_robot {

/// The savings by look-ahead of the transitions that a mission asked for.
struct LookAheadSaving {
  std::size_t transitions = 0;  ///< that found tasks prepared
  Duration saved{0};            ///< of all of them
  friend bool operator==(const LookAheadSaving&, const LookAheadSaving&) = default;
};

/// A robot that offers a RobotService: one in another process (control::connect), or in this one
/// (runtime::RuntimeService). One that does not say in time what became of its lease is lost, for good:
/// whoever waits for it, and whatever it is asked later, fails at once with Unavailable. Thread safe.
class ServedRobot final : public mission::CommandedRobot, public mission::UnitKeeper {
 public:
  /// `service` must outlive this; `who` requests controllers, for the robot's journal.
  ServedRobot(control::RobotService& service, std::string who) : service_(service), who_(std::move(who)) {}

  /// Sets a function to be called, on any thread and maybe more than once, when the robot says that its
  /// mission is stopped: from then on it refuses all commands. To be set before any call.
  void when_stopped(std::function<void()> stopped) { when_stopped_ = std::move(stopped); }
  /// Takes the lease now, rather than with the first request.
  Result<void> take();
  /// The requests to the holder of the lease since the last call (control::RobotLease::asked). Takes the
  /// lease where it is not held yet.
  Result<std::vector<control::HolderRequest>> asked();
  /// Reports the mission's work; `doing` is a map. Also sends the waiting events of record(), for the robot's
  /// journal.
  Result<void> report(type::Value doing);
  /// Ends the command of the robot, which is to `keep` running its controller, or comes to rest; answers
  /// null, or like control::RobotService::give_back(). Nothing can be requested afterwards.
  Result<type::Value> give_back(bool keep, Deadline deadline);
  /// The events of the mission. Once a mission has begun there, requests are in the name of its actions.
  [[nodiscard]] MissionRecord& record() { return record_; }

  /// Tells the robot the oldest changes of its units that it has not taken yet.
  Result<void> tell_units();
  /// Whether there are some.
  [[nodiscard]] bool has_units_to_tell() const { return units_.has_waiting(); }

  [[nodiscard]] LookAheadSaving saved() const;

  Result<mission::UnitCounts> counts() override;
  Result<void> begin(const std::string& journal, const mission::UnitCounts& counts) override;
  void changed(const mission::Execution& execution, const mission::UnitChanges& changes) override {
    units_.changed(execution, changes);
  }

  Result<void> request(const mission::ControllerRequest& what, const Wait& wait) override;
  Result<mission::ControllerTrouble> trouble(std::string_view controller, const Wait& wait) override;
  Result<std::optional<std::string>> lost_command(const std::stop_token& stop) override;
  Result<mission::ControllerConflicts> conflicts(const Wait& wait) override;
  Result<std::vector<mission::PoolView>> pools(const Wait& wait) override;
  void take_instance(const model::InstanceQuestion& what, const Wait& wait,
                     model::InstanceAnswer answered) override;
  Result<void> prepare(const std::vector<std::string>& controllers, const Wait& wait) override;
  Result<type::Value> call(const mission::Member& operation, const type::Value& arguments,
                           const Wait& wait) override;
  Result<void> set(const mission::Member& property, const type::Value& value, const Wait& wait) override;
  Result<void> write(const mission::Member& port, const type::Value& value, const Wait& wait) override;
  void watch(const mission::TaskQuestion& question, const Wait& wait, mission::TaskAnswer answered) override;
  void changes(std::uint64_t seen, const Wait& wait, mission::ChangesAnswer answered) override;
  Result<std::unique_ptr<mission::PortSamples>> open(const mission::Member& port, const Wait& wait) override;

 private:
  Result<std::uint64_t> lease();
  Result<void> report_units(type::Value units);
  /// The lease, to be looked at; null: it was not taken, or was given back.
  Result<std::shared_ptr<control::RobotLease>> present_lease() const;
  /// The robot's answer about its lease, which it gives at once. DeadlineExceeded: it is lost.
  template <class T>
  Result<T> heard(Result<T> answer);
  /// Calls `ask(wait)`, which ends, too, where the robot is lost.
  template <class Ask>
  auto command(const Wait& wait, Ask ask) -> decltype(ask(wait));
  [[nodiscard]] std::optional<Error> loss() const;
  /// Why nothing may be commanded any more.
  [[nodiscard]] std::optional<Error> refusal() const;
  [[nodiscard]] std::optional<std::string> lost_by(const control::LeaseStanding& standing) const;
  /// Calls `ask(wait)`, which only looks, and ends, too, where the robot is lost.
  template <class Ask>
  auto query(const Wait& wait, Ask ask) const -> decltype(ask(wait));
  /// Calls `ask(wait, answered)`, which only looks and returns at once; `answered` is called, too, where the
  /// robot is lost.
  template <class T, class Ask>
  void query_later(const Wait& wait, std::function<void(Result<T>)> answered, Ask ask) const;
  [[nodiscard]] control::Sender sender() const;
  void count_saving(const type::Value& transition);
  [[nodiscard]] std::string requester(const mission::ControllerRequest& what) const;

  control::RobotService& service_;
  const std::string who_;
  std::function<void()> when_stopped_ = [] {};
  MissionRecord record_;
  UnitRecord units_;
  /// Held while the lease is looked at: a caller that comes after one whose query was not answered knows that
  /// the robot is lost, and need not wait as long again.
  class LeaseCheck;
  Mutex looking_mutex_;  ///< protects the next one
  bool is_looked_at_ SEGUE_GUARDED_BY(looking_mutex_) = false;
  StoppableConditionVariable looked_;
  mutable Mutex mutex_;                                                  ///< protects all below
  std::shared_ptr<control::RobotLease> lease_ SEGUE_GUARDED_BY(mutex_);  ///< taken by the first request
  bool given_back_ SEGUE_GUARDED_BY(mutex_) = false;
  LookAheadSaving saved_ SEGUE_GUARDED_BY(mutex_);
  std::optional<Error> why_lost_ SEGUE_GUARDED_BY(mutex_);
  std::stop_source lost_;  ///< stopped after `why_lost_` is set
};

}  // namespace segue::remote_robot
