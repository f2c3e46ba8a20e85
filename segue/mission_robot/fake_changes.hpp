// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/mission/commanded_robot.hpp>

#include <cstdint>
#include <utility>
#include <vector>

namespace segue::mission {

/// Counts changes of a robot, as CommandedRobot::changes(); questions wait until there is one, however long.
/// For tests. Thread safe.
class FakeChanges {
 public:
  void add() {
    std::vector<ChangesAnswer> waiting;
    Lock lock(mutex_);
    const std::uint64_t now = ++count_;
    if (is_silent_) return;
    waiting.swap(waiting_);
    lock.unlock();
    for (const ChangesAnswer& answered : waiting)
      answered(now);
  }
  [[nodiscard]] std::uint64_t count() {
    const Lock lock(mutex_);
    return count_;
  }
  /// Nobody who waits hears of a change any more.
  void be_silent() {
    const Lock lock(mutex_);
    is_silent_ = true;
  }
  void watch(std::uint64_t seen, ChangesAnswer answered) {
    Lock lock(mutex_);
    if (seen == count_) return waiting_.push_back(std::move(answered));
    const std::uint64_t now = count_;
    lock.unlock();
    answered(now);
  }

 private:
  Mutex mutex_;  ///< protects all below
  bool is_silent_ = false;
  std::uint64_t count_ = 1;
  std::vector<ChangesAnswer> waiting_;
};

}  // namespace segue::mission
