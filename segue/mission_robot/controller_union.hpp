// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/commanded_robot.hpp>

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace segue::mission {

/// An execution of an action that uses controllers.
struct ControllerUser {
  std::string action{};  ///< its path; empty: the mission is that action
  std::uint64_t iteration = 0;
};

/// A caller's interest in a controller: on behalf of whom, and for how long.
struct ControllerWish {
  std::optional<ControllerUser> user{};  ///< for the record
  std::stop_token stop{};                ///< requested: no longer
  /// Whether the robot may run the controller on although it is not wanted any more, like `keep` of
  /// ControllerUnion::end().
  bool keep = true;
};

/// The network that a robot runs for the actions of a mission: the union of the controllers that they use now
/// and of those that are kept from earlier ones. A kept one stays as long as nothing else needs the robot and
/// it does not write to tasks of a controller in use. One transition at a time; requests that come meanwhile,
/// or at about the same time, are joined to one transition. A controller that runs already waits for no
/// others, and is requested only where the robot says that it does not run as it should. One that nobody
/// wants any more is not requested, and a transition that nobody wants any more is undone where it has not
/// committed. Thread safe.
class ControllerUnion {
 public:
  /// How requests of actions that run at the same time become one transition.
  struct Options {
    Duration gather = std::chrono::milliseconds(3);  ///< how long a transition waits for others to join it
    /// How long a controller that was seen to run is not looked at anew.
    Duration fresh = std::chrono::milliseconds(10);
    Duration deadline = std::chrono::seconds(60);  ///< of a request
  };
  ControllerUnion(std::shared_ptr<CommandedRobot> robot, Options options);
  /// Gives up the request in progress. No caller may wait here any more.
  ~ControllerUnion();
  ControllerUnion(const ControllerUnion&) = delete;
  ControllerUnion& operator=(const ControllerUnion&) = delete;

  /// Has the robot run that controller, with these properties in place of its own, beside those that others
  /// use. Blocks until it does; the error says why it does not, and what others use runs on. Cancelled, at
  /// once, where it is wanted no longer: then it is not in use.
  Result<void> begin(const std::string& controller, std::vector<MemberValue> properties,
                     ControllerWish wish = {});
  /// Notes that the robot runs the controller already, with these properties, for an action of an earlier run
  /// that goes on. Requests nothing from the robot, so it gets no lease.
  void take_over(const std::string& controller, std::vector<MemberValue> properties);
  /// Ends the use of a controller by an action. `keep`: the controller runs on until something else is needed
  /// in its place; otherwise the robot stops it, and this blocks until it has.
  Result<void> end(const std::string& controller, bool keep, std::optional<ControllerUser> user = {});
  /// Notes that a user of the controller has asked the robot after `asked`, and that the controller ran as it
  /// should, still when the answer came at `seen`.
  void note_runs(const std::string& controller, TimePoint asked, TimePoint seen);
  /// The network may have been changed otherwise than by a request: earlier observations of it count no
  /// longer.
  void note_changed();
  /// How many callers wait for the next transition.
  [[nodiscard]] std::size_t waiting() const;

 private:
  struct Member {
    std::string controller;
    std::vector<MemberValue> properties;
    int users = 0;     ///< 0: kept
    TimePoint seen{};  ///< to run, since it was requested last
  };
  /// A begin() or an end() without `keep` that waits.
  struct Change {
    Member member;
    bool stop = false;
    ControllerWish wish{};
    bool given_up = false;  ///< it was wanted no longer when the robot had answered
    std::optional<Result<void>> outcome{};
    [[nodiscard]] bool is_wanted() const { return !wish.stop.stop_requested(); }
  };
  using Changes = std::vector<std::shared_ptr<Change>>;
  using Members = std::list<Member>;  ///< the latest first

  bool may_run(const std::string& controller, const std::vector<MemberValue>& properties);
  bool runs_well(const std::string& controller, const Wait& wait);
  bool use_what_runs(const std::string& controller, const std::vector<MemberValue>& properties,
                     TimePoint earliest);
  Result<void> carry_out(Change change);
  void withdraw(const std::shared_ptr<Change>& change) SEGUE_REQUIRES(mutex_);
  void work(const std::stop_token& end);
  [[nodiscard]] bool is_transition(const Change& change) const SEGUE_REQUIRES(mutex_);
  Members::iterator find(const std::string& controller) SEGUE_REQUIRES(mutex_);
  Members::iterator find_undisturbed(const std::string& controller,
                                     const std::vector<MemberValue>& properties) SEGUE_REQUIRES(mutex_);
  void serve_waiting() SEGUE_REQUIRES(mutex_);
  Result<void> serve(const Changes& changes) SEGUE_REQUIRES(mutex_);
  void stop_unwanted(const Changes& changes) SEGUE_REQUIRES(mutex_);
  [[nodiscard]] Members with(const Changes& changes) const SEGUE_REQUIRES(mutex_);
  [[nodiscard]] bool fits(const std::string& controller, const Members& members) const SEGUE_REQUIRES(mutex_);
  [[nodiscard]] bool disturbs(const std::string& kept, const std::string& used) const SEGUE_REQUIRES(mutex_);
  // These two ask the robot, and give back the mutex meanwhile.
  Result<void> request(const Members& members, const Changes& changes) SEGUE_REQUIRES(mutex_);
  void learn_conflicts(const std::stop_token& end) SEGUE_REQUIRES(mutex_);

  const std::shared_ptr<CommandedRobot> robot_;
  const Options options_;
  mutable Mutex mutex_;  ///< protects all below; not held while the robot is asked
  StoppableConditionVariable changed_;
  std::optional<ControllerConflicts> conflicts_ SEGUE_GUARDED_BY(mutex_);
  Members members_ SEGUE_GUARDED_BY(mutex_);
  Changes waiting_ SEGUE_GUARDED_BY(mutex_);
  Changes served_ SEGUE_GUARDED_BY(mutex_);             ///< that the robot is asked for now
  std::stop_source unwanted_ SEGUE_GUARDED_BY(mutex_);  ///< stops that request
  bool has_lease_ SEGUE_GUARDED_BY(mutex_) = false;     ///< the robot has carried out a request of this
  /// The time when the robot was asked for another controller, or its network was changed otherwise.
  TimePoint changed_at_ SEGUE_GUARDED_BY(mutex_){};
  std::jthread thread_;  ///< asks the robot
};

}  // namespace segue::mission
