// SPDX-License-Identifier: Apache-2.0
#include <segue/model/action_times.hpp>

namespace segue::model {

void DurationRecord::add(Duration duration) {
  ++count;
  mean += (duration - mean) / static_cast<std::int64_t>(count);
  if (recent.size() >= kRecent) recent.erase(recent.begin());
  recent.push_back(duration);
}

}  // namespace segue::model
