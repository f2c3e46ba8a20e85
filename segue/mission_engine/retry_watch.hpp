// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/mission/program.hpp>

#include <cstdint>
#include <string>
#include <unordered_map>

namespace segue::mission {

/// Notices a state that aborts again and again without a pause, by the clock of the run: a mission that tries
/// it again at once may do so for ever, and uses a whole processor. For one thread.
class RetryWatch {
 public:
  static constexpr std::uint32_t kAborts = 1000;
  static constexpr Duration kWithin = std::chrono::seconds(10);

  /// The state has ended, at `now`, which matters where it aborted. True once for each state: it has now
  /// aborted kAborts times in a row within kWithin.
  [[nodiscard]] bool ended(StateIndex state, Outcome outcome, TimePoint now);
  /// The warning that people then get.
  [[nodiscard]] static std::string warning();

 private:
  struct Aborts {
    std::uint32_t count = 0;  ///< in a row
    bool told = false;
    TimePoint first{};
  };
  std::unordered_map<StateIndex, Aborts> aborting_;
};

}  // namespace segue::mission
