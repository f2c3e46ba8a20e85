// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_engine/retry_watch.hpp>

namespace segue::mission {

bool RetryWatch::ended(StateIndex state, Outcome outcome, TimePoint now) {
  if (outcome != kAborted) {
    if (const auto found = aborting_.find(state); found != aborting_.end()) found->second.count = 0;
    return false;
  }
  Aborts& aborts = aborting_[state];
  if (aborts.told) return false;
  if (++aborts.count == 1) aborts.first = now;
  if (aborts.count < kAborts) return false;
  aborts.told = now - aborts.first <= kWithin;
  aborts.count = 0;
  return aborts.told;
}

std::string RetryWatch::warning() {
  return "has aborted " + std::to_string(kAborts) + " times in a row within " +
         std::to_string(std::chrono::duration_cast<std::chrono::seconds>(kWithin).count()) +
         " s; the mission tries it again without a pause, perhaps for ever";
}

}  // namespace segue::mission
