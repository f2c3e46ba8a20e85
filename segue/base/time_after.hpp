// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>

namespace segue {

/// The time that is so long after `time`; InvalidArgument where that is beyond what a TimePoint can hold: 292
/// years after its epoch. Allocates only where it fails.
[[nodiscard]] inline Result<TimePoint> time_after(TimePoint time, Duration duration) {
  Duration::rep sum = 0;
  if (!__builtin_add_overflow(time.time_since_epoch().count(), duration.count(), &sum))
    return TimePoint(Duration(sum));
  return fail(ErrorCode::InvalidArgument,
              "it would end after more than 292 years, which is as long as time can be");
}

/// The sum of two lengths of time, at most the longest that there is.
[[nodiscard]] inline Duration sum_of_durations(Duration one, Duration other) {
  Duration::rep sum = 0;
  if (!__builtin_add_overflow(one.count(), other.count(), &sum)) return Duration(sum);
  return one < Duration::zero() ? Duration::min() : Duration::max();
}

}  // namespace segue
