// SPDX-License-Identifier: Apache-2.0
// SIGKILL of random deployment processes at random times, while random controllers are requested.
// SEGUE_KILL_ROUNDS=2000 runs as many rounds, SEGUE_SEED=n another sequence of them.
#include <support/number_from.hpp>
#include <support/sanitizers.hpp>

#include <array>
#include <csignal>
#include <random>
#include <thread>

#include "disturbed_transition.hpp"

namespace segue::testing {
namespace {

using runtime::Outcome;
using runtime::SwitchResult;

constexpr int kRounds = kSanitized ? 10 : 60;

class KilledAtRandom : public DisturbedTransition {
 protected:
  /// Kills a process of the robot, without waiting for its end.
  void kill_any() {
    const auto running = deployments();
    if (running.empty()) return;
    const auto victim = std::next(running.begin(), static_cast<std::ptrdiff_t>(random_() % running.size()));
    if (victim->second > 0) ::kill(victim->second, SIGKILL);
  }
  const model::Network& any() {
    const std::array<const model::Network*, 4> all = {&one_, &two_, &moved_, &plain_};
    return *all.at(random_() % all.size());
  }
  /// Every request ends with an outcome that its error explains.
  static void expect_explained(const SwitchResult& result) {
    EXPECT_EQ(result.outcome == Outcome::Done, !result.error.has_value());
    if (result.outcome == Outcome::Failed) {
      EXPECT_TRUE(result.undo.has_value());
    }
  }

  const model::Network plain_ = network("plain");
  const model::Network moved_ = network("moved", kRelay, "  other: {tasks: [relay]}\n", kFlow);
  std::mt19937_64 random_{static_cast<std::uint64_t>(number_from("SEGUE_SEED", 1))};
};

TEST_F(KilledAtRandom, processes_leave_a_robot_that_reaches_its_next_controller) {
  const int rounds = number_from("SEGUE_KILL_ROUNDS", kRounds);
  for (int round = 0; round < rounds && !HasFailure(); ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    auto first = runtime().request(any());
    std::this_thread::sleep_for(std::chrono::microseconds(random_() % 30'000));
    kill_any();
    auto second = runtime().request(any());
    if (random_() % 2 == 0) kill_any();
    expect_explained(first.get());
    expect_explained(second.get());
    const model::Network& target = any();
    recover_to(target);
    for (const char* watcher : {"watcher", "witness"})
      EXPECT_EQ(sight(watcher).torn, 0U);
    EXPECT_TRUE(eventually([&] { return deployments().size() == target.deployments.size(); }));
  }
}

}  // namespace
}  // namespace segue::testing
