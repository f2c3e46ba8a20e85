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
#include <vector>

namespace segue::mission {

/// Follows the states of some tasks of a robot: each by one question at a time, which is answered when the
/// task has changed, so a process that does not answer delays none of the others. One thread uses this.
class WatchedTasks {
 public:
  /// The least time between questions for updates alone.
  static constexpr Duration kBetweenUpdates = std::chrono::milliseconds(10);
  /// How long a question waits; then it is asked again.
  static constexpr Duration kPatience = std::chrono::seconds(10);

  /// The time between questions for a task that cannot be seen.
  static constexpr Duration kBetweenTries = std::chrono::milliseconds(250);

  /// `robot` must outlive this. Answers ring `bell`.
  WatchedTasks(CommandedRobot& robot, std::shared_ptr<Bell> bell, Duration between_tries = kBetweenTries)
      : robot_(robot), bell_(std::move(bell)), between_tries_(between_tries) {}

  /// Follows that task; its updates are changes, too, while there have been no more than `after`.
  /// `patience`: how long a question waits. One that was gone is seen again when it runs. That it cannot be
  /// seen is an error of poll().
  void follow(const std::string& task, std::uint64_t after, Duration patience = kPatience);
  /// Follows the task like follow(), but it is not an error of poll() that the task cannot be seen.
  void follow_if_seen(const std::string& task, std::uint64_t after = 0, Duration patience = kPatience);
  /// Takes in the answers that have come. The error of a task that cannot be seen: where one is gone, the
  /// robot may have it anew, so only a question for its present level can fail.
  Result<void> poll();
  /// Asks of the tasks that are not being asked of, where it is time.
  void ask();
  /// When ask() has something to do although the bell does not ring.
  [[nodiscard]] TimePoint next_question() const;

  /// The ids of all followed tasks.
  [[nodiscard]] std::vector<std::string> ids() const;
  /// The tasks that have begun anew since the last call: they were gone, or have run before and do so again,
  /// and have lost their commands. Their updates count from the beginning.
  [[nodiscard]] std::vector<std::string> take_begun_anew();
  [[nodiscard]] bool has_begun_anew() const;
  /// Notes that somebody has seen that the task does not run: once it does, it has begun anew.
  void note_gone(std::string_view task);
  /// Whether a task that was gone has not been seen to run again.
  [[nodiscard]] bool lacks_any() const;
  /// The task as the last poll() found it. Null: nothing is known yet.
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
    bool must_be_seen = false;
    std::uint64_t updates = 0;  ///< as of the last answer
    bool is_gone = false;       ///< it was seen, and has not run since
    bool has_stopped = false;   ///< it has run, and does not any more
    bool is_anew = false;
    TimePoint ask_at{};
    Question<TaskView> question;
  };

  One& follow_one(const std::string& task, std::uint64_t after, Duration patience);
  Result<void> take(One& one);
  static void note_life(One& one, const TaskView& now, bool runs);
  void ask(One& one);
  [[nodiscard]] const One* find(std::string_view task) const;

  CommandedRobot& robot_;
  const std::shared_ptr<Bell> bell_;
  const Duration between_tries_;
  std::list<One> tasks_;
};

}  // namespace segue::mission
