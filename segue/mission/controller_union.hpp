// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/commanded_robot.hpp>

#include <condition_variable>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace segue::mission {

/// An execution of an action that uses controllers.
struct ControllerUser {
  std::string action{};  ///< its path; empty: the mission is that action
  std::uint64_t iteration = 0;
};

/// What the actions of a mission have a robot run: the union of the controllers that they use now and of
/// those that are kept from earlier ones, as long as nothing needs the robot otherwise and they do not write
/// to tasks of what is in use. One transition at a time; what is asked meanwhile, or at about the same time,
/// is one transition. Thread safe.
class ControllerUnion {
 public:
  struct Options {
    Duration gather = std::chrono::milliseconds(3);  ///< how long a transition waits for others to join it
    Duration deadline = std::chrono::seconds(60);    ///< of a request
  };
  ControllerUnion(std::shared_ptr<CommandedRobot> robot, Options options)
      : robot_(std::move(robot)), options_(options) {}

  /// Has the robot run that controller, with these properties in place of its own, beside those that others
  /// use. Blocks until it does; the error says why it does not, and what others use runs on.
  /// `user`: the action, for the record.
  Result<void> begin(const std::string& controller, std::vector<MemberValue> properties,
                     std::optional<ControllerUser> user = {});
  /// The robot runs it already, with these properties, for an action of an earlier run that goes on. As
  /// begin(), but asks the robot for nothing.
  void take_over(const std::string& controller, std::vector<MemberValue> properties);
  /// The action that had begun it has ended. `keep`: it runs on until something else is needed in its place;
  /// otherwise the robot stops it, and this blocks until it has.
  Result<void> end(const std::string& controller, bool keep, std::optional<ControllerUser> user = {});

 private:
  struct Member {
    std::string controller;
    std::vector<MemberValue> properties;
    int users = 0;  ///< 0: kept
  };
  /// A begin() or an end() without `keep` that waits.
  struct Change {
    Member member;
    bool stop = false;
    std::optional<ControllerUser> user{};
    std::optional<Result<void>> outcome{};
  };
  using Members = std::list<Member>;  ///< the latest first

  Result<void> carry_out(Change change);
  void serve_waiting(std::unique_lock<std::mutex>& lock);
  void serve(const std::vector<Change*>& changes, std::unique_lock<std::mutex>& lock);
  [[nodiscard]] Members with(const std::vector<Change*>& changes) const;
  [[nodiscard]] bool fits(const std::string& controller, const Members& members) const;
  Result<void> request(const Members& members, const std::vector<Change*>& changes,
                       std::unique_lock<std::mutex>& lock);
  void learn_conflicts(std::unique_lock<std::mutex>& lock);

  const std::shared_ptr<CommandedRobot> robot_;
  const Options options_;
  std::mutex mutex_;  ///< protects all below; not held while the robot is asked
  std::condition_variable changed_;
  bool busy_ = false;  ///< a thread asks the robot for what all wait for
  std::optional<ControllerConflicts> conflicts_;
  Members members_;
  std::vector<Change*> waiting_;
};

}  // namespace segue::mission
