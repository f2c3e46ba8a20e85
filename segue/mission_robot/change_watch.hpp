// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/question.hpp>
#include <segue/mission/commanded_robot.hpp>

#include <chrono>
#include <cstdint>
#include <memory>

namespace segue::mission {

/// Learns when the controllers of a robot, its faults or its commander may have changed. One thread uses
/// this.
class ChangeWatch {
 public:
  /// How long a question waits; then it counts as news.
  static constexpr Duration kPatience = std::chrono::seconds(10);
  /// The least time between two questions.
  static constexpr Duration kBetweenNews = std::chrono::milliseconds(10);
  /// The time before the next question after one that failed.
  static constexpr Duration kBetweenTries = std::chrono::milliseconds(250);

  /// `robot` must outlive this. News ring `bell`.
  ChangeWatch(CommandedRobot& robot, std::shared_ptr<Bell> bell);
  /// Asks, unless it has asked already or it is not yet time. The first answer comes at once.
  void ask();
  /// Whether there may be news since the last call.
  [[nodiscard]] bool take();
  /// The count as of the last call of take(); 0: not known yet.
  [[nodiscard]] std::uint64_t seen() const { return seen_; }
  /// When ask() has something to do although the bell does not ring.
  [[nodiscard]] TimePoint next_question() const;

 private:
  CommandedRobot& robot_;
  std::uint64_t seen_ = 0;
  TimePoint ask_at_{};
  Question<std::uint64_t> question_;
};

}  // namespace segue::mission
