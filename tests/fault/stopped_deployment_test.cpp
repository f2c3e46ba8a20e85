// SPDX-License-Identifier: Apache-2.0
// A deployment process is stopped (SIGSTOP) before every action of a transition in turn: calls to it time
// out, and it is replaced.
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

/// Stops in turn a process that the transition changes, one that it ends and one that it starts. Each stop
/// costs seconds of waiting, so by default it happens before every other action only.
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
