// SPDX-License-Identifier: Apache-2.0
// A deployment process is stopped (SIGSTOP) before every action of a transition in turn: calls to it time
// out, and it is replaced.
#include <array>
#include <csignal>
#include <cstdlib>
#include <map>
#include <string>

#include "disturbed_transition.hpp"

namespace segue::testing {
namespace {

class StoppedDuringTransition : public DisturbedTransition {
 protected:
  void SetUp() override {
    options_.patience = std::chrono::milliseconds(500);
    DisturbedTransition::SetUp();
  }
};

/// Stops in turn a process that the transition changes, one that it ends and one that it starts. Each stop
/// costs seconds of waiting, so by default it happens before every other action only.
constexpr std::array kVictims = {"work", "old", "fresh"};

TEST_F(StoppedDuringTransition, OneOfItsProcesses) {
  std::map<std::string, int> stops;
  before_every_action(
      "a process is stopped",
      [&](std::size_t action) {
        if (action % 2 != 0 && std::getenv("SEGUE_ALL_FAULTS") == nullptr) return;
        const std::string victim = kVictims.at(action % kVictims.size());
        if (const pid_t pid = pid_of(victim); pid > 0) stops[victim] += ::kill(pid, SIGSTOP) == 0 ? 1 : 0;
      },
      {}, std::chrono::seconds(1));
  for (const char* victim : kVictims)
    EXPECT_GT(stops[victim], 0) << victim << " exists before some of the actions";
}

}  // namespace
}  // namespace segue::testing
