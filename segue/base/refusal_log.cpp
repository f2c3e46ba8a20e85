// SPDX-License-Identifier: Apache-2.0
#include <segue/base/log.hpp>
#include <segue/base/refusal_log.hpp>

#include <algorithm>
#include <utility>

namespace segue {

bool RefusalLog::take_line() {
  const TimePoint now = monotonic_now();
  const auto gained = (now - refilled_) / kRefill;
  if (gained > 0) {
    lines_ = static_cast<int>(std::min<std::int64_t>(kBurst, lines_ + gained));
    refilled_ = now;
  }
  if (lines_ == 0) return false;
  --lines_;
  return true;
}

void RefusalLog::tell(const std::string& who, const std::string& why) {
  if (!take_line()) {
    ++left_out_;
    return;
  }
  std::string line = "refused " + who + ": " + why;
  if (const auto left_out = std::exchange(left_out_, 0); left_out > 0) {
    line += " (before it, " + std::to_string(left_out) + " more refusals were not logged)";
  }
  log(LogLevel::Warning, component_, line);
}

void RefusalLog::settle() {
  if (left_out_ == 0 || !take_line()) return;
  log(LogLevel::Warning, component_,
      std::to_string(std::exchange(left_out_, 0)) +
          " more refusals were not logged, since they came too fast");
}

}  // namespace segue
