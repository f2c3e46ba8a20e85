// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

#include <chrono>
#include <cstdint>

namespace segue::task::detail {

/// Chooses the samples of a writer that carry the time at which they were written: all of a slow writer, of a
/// fast one about as many as fit into kBetween, and one of kMostStride at the least. So a fast writer does
/// not read the clock for each sample. The writing thread only; real-time safe.
class SampleStamps {
 public:
  static constexpr Duration kBetween = std::chrono::milliseconds(10);
  static constexpr std::uint32_t kMostStride = 64;

  /// The time for the next sample, for which `now` is called; TimePoint() where it carries none.
  template <class Now>
  [[nodiscard]] TimePoint next(Now now) noexcept {
    return --left_ > 0 ? TimePoint() : stamp(now());
  }

 private:
  TimePoint stamp(TimePoint now) noexcept {
    if (now - last_ >= kBetween) {
      stride_ = stride_ > 1 ? stride_ / 2 : 1;
    } else if (stride_ < kMostStride) {
      stride_ *= 2;
    }
    left_ = stride_;
    last_ = now;
    return now;
  }

  std::uint32_t left_ = 1;
  std::uint32_t stride_ = 1;
  TimePoint last_{};
};

}  // namespace segue::task::detail
