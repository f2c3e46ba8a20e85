// SPDX-License-Identifier: Apache-2.0
// A deployment process is stopped altogether (SIGSTOP) before every action of a transition in turn: whoever
// waits for it gives up, and it is replaced.
#include <array>
#include <csignal>
#include <cstdlib>

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

/// One that the transition changes, one that it ends, one that it starts, in turn. Each stop costs its
/// seconds of patience: before every other action, and before all only where somebody has the time.
constexpr std::array kVictims = {"work", "old", "fresh"};

TEST_F(StoppedDuringTransition, one_of_its_processes) {
  before_every_action(
      "a process is stopped",
      [&](std::size_t action) {
        if (action % 2 != 0 && std::getenv("SEGUE_ALL_FAULTS") == nullptr) return;
        const pid_t pid = pid_of(kVictims.at(action % kVictims.size()));
        if (pid > 0) ::kill(pid, SIGSTOP);
      },
      {}, std::chrono::seconds(1));
}

}  // namespace
}  // namespace segue::testing
