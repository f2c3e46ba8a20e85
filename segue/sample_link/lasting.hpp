// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

#include <optional>

namespace segue::sample_link {

/// Tells lasting damage from a state that looks wrong for a moment, because another thread or process is just
/// changing it: damage is there whenever somebody looks, for some seconds.
class Lasting {
 public:
  static constexpr Duration kLongestChange = std::chrono::seconds(2);

  /// Notes one look; whether it has been wrong long enough.
  bool is(bool wrong, TimePoint now) noexcept {
    if (!wrong) {
      since_.reset();
    } else if (!since_) {
      since_ = now;
    }
    return since_ && now - *since_ > kLongestChange;
  }

 private:
  std::optional<TimePoint> since_;
};

}  // namespace segue::sample_link
