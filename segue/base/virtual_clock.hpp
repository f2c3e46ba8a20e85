// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>

namespace segue {

/// A clock that moves only when advance() is called: for tests and simulation.
class VirtualClock final : public Clock {
 public:
  [[nodiscard]] TimePoint now() const override;
  void sleep_until(TimePoint when) override;
  /// Moves time forward and wakes the threads that were waiting for it.
  void advance(Duration step);

 private:
  mutable Mutex mutex_;  ///< guards now_
  ConditionVariable moved_;
  TimePoint now_ SEGUE_GUARDED_BY(mutex_){};
};

}  // namespace segue
