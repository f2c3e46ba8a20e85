// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/commanded_robot.hpp>

#include <cstdint>
#include <mutex>
#include <utility>
#include <vector>

namespace segue::mission {

/// Counts changes of a robot, as CommandedRobot::changes(); questions wait until there is one, however long.
/// For tests. Thread safe.
class FakeChanges {
 public:
  void add() {
    std::vector<ChangesAnswer> waiting;
    std::unique_lock lock(mutex_);
    const std::uint64_t now = ++count_;
    waiting.swap(waiting_);
    lock.unlock();
    for (const ChangesAnswer& answered : waiting)
      answered(now);
  }
  void watch(std::uint64_t seen, ChangesAnswer answered) {
    std::unique_lock lock(mutex_);
    if (seen == count_) return waiting_.push_back(std::move(answered));
    const std::uint64_t now = count_;
    lock.unlock();
    answered(now);
  }

 private:
  std::mutex mutex_;  ///< protects both
  std::uint64_t count_ = 1;
  std::vector<ChangesAnswer> waiting_;
};

}  // namespace segue::mission
