// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/question.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/commanded_robot.hpp>

#include <chrono>
#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace segue::mission {

/// Follows how some tasks of a robot are: each by one question at a time, which is answered when the task has
/// changed, so a process that is silent delays nothing of the others. One thread uses this.
class WatchedTasks {
 public:
  /// Between questions for updates alone, at least.
  static constexpr Duration kBetweenUpdates = std::chrono::milliseconds(10);
  /// How long a question waits; then it is asked again.
  static constexpr Duration kPatience = std::chrono::seconds(10);

  /// `robot` must outlive this. Answers ring `bell`.
  WatchedTasks(CommandedRobot& robot, std::shared_ptr<Bell> bell) : robot_(robot), bell_(std::move(bell)) {}

  /// Follows that task; its updates are changes, too, while there have been no more than `after`.
  /// `patience`: how long a question waits.
  void follow(const std::string& task, std::uint64_t after, Duration patience = kPatience);
  /// Takes in the answers that have come. The error of a task that cannot be seen: where one is gone, the
  /// robot may have it anew, so only a question for its present level can fail.
  Result<void> look();
  /// Asks of the tasks that are not being asked of, where it is time.
  void ask();
  /// When ask() has something to do although the bell does not ring.
  [[nodiscard]] TimePoint next_question() const;

  /// As of the last look(). Null: nothing is known yet.
  [[nodiscard]] const TaskView* view(std::string_view task) const;
  /// Counts answers.
  [[nodiscard]] std::uint64_t news(std::string_view task) const;

 private:
  struct One {
    One(std::string id, std::shared_ptr<Bell> bell) : task(std::move(id)), question(std::move(bell)) {}
    const std::string task;
    std::uint64_t after = 0;
    Duration patience = kPatience;
    std::optional<TaskView> view{};
    std::uint64_t news = 0;
    TimePoint ask_at{};
    Question<TaskView> question;
  };

  Result<void> take(One& one);
  void ask(One& one);
  [[nodiscard]] const One* find(std::string_view task) const;

  CommandedRobot& robot_;
  const std::shared_ptr<Bell> bell_;
  std::list<One> tasks_;
};

}  // namespace segue::mission
