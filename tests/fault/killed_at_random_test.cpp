// SPDX-License-Identifier: Apache-2.0
// SIGKILL of random deployment processes at random points of transitions, while random controllers are
// requested.
// SEGUE_KILL_ROUNDS=2000 runs as many rounds, SEGUE_SEED=n another sequence of them.
#include <support/number_from.hpp>
#include <support/sanitizers.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <future>
#include <memory>
#include <random>

#include "disturbed_transition.hpp"

namespace segue::testing {
namespace {

using runtime::Outcome;
using runtime::SwitchResult;

constexpr int kRounds = kSanitized ? 10 : 60;

class KilledAtRandom : public DisturbedTransition {
 protected:
  /// Kills a process of the robot, without waiting for its end; whether there was one.
  bool kill_one(std::uint64_t which) const {
    const auto running = deployments();
    if (running.empty()) return false;
    const auto victim = std::next(running.begin(), static_cast<std::ptrdiff_t>(which % running.size()));
    return victim->second > 0 && ::kill(victim->second, SIGKILL) == 0;
  }
  const model::Network& any() {
    const std::array<const model::Network*, 4> all = {&one_, &two_, &moved_, &plain_};
    return *all.at(random_() % all.size());
  }
  const model::Network& any_but(const model::NetworkName& name) {
    while (true) {
      if (const auto& found = any(); found.name != name) return found;
    }
  }
  /// Requests a network that does not run, and returns when a process was killed before one of the actions
  /// that this takes, or the request has failed because of one that was killed before.
  std::future<SwitchResult> request_and_kill() {
    const auto& target = any_but(runtime().belief().name);
    const auto plan = runtime().plan(target);
    EXPECT_TRUE(plan) << to_string(plan.error());
    const std::size_t at = random_() % std::max<std::size_t>(plan ? plan->actions.size() : 0, 1);
    const auto begun = std::make_shared<std::atomic<std::size_t>>(0);
    const auto reached = std::make_shared<std::atomic<bool>>(false);
    life_->asking().ask([this, at, begun, reached, which = random_()](const model::Action&) -> Result<void> {
      if ((*begun)++ != at) return {};
      in_transitions_ += kill_one(which) ? 1 : 0;
      *reached = true;
      return {};
    });
    auto result = runtime().request(target);
    EXPECT_TRUE(eventually(
        [&] { return *reached || result.wait_for(std::chrono::seconds(0)) == std::future_status::ready; }));
    life_->asking().ask(nullptr);
    return result;
  }
  /// Every request ends with an outcome that its error explains.
  static void expect_explained(const SwitchResult& result) {
    EXPECT_EQ(result.outcome == Outcome::Done, !result.error.has_value());
    if (result.outcome == Outcome::Failed) {
      EXPECT_TRUE(result.undo.has_value());
    }
  }

  std::atomic<int> in_transitions_{0};  ///< kills before an action
  const model::Network plain_ = network("plain");
  const model::Network moved_ = network("moved", kRelay, "  other: {tasks: [relay]}\n", kFlow);
  std::mt19937_64 random_{static_cast<std::uint64_t>(number_from("SEGUE_SEED", 1))};
};

TEST_F(KilledAtRandom, ProcessesLeaveARobotThatReachesItsNextController) {
  const int rounds = number_from("SEGUE_KILL_ROUNDS", kRounds);
  for (int round = 0; round < rounds && !HasFailure(); ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    auto first = request_and_kill();
    auto second = runtime().request(any());
    if (random_() % 2 == 0) kill_one(random_());
    expect_explained(first.get());
    expect_explained(second.get());
    const model::Network& target = any();
    recover_to(target);
    for (const char* watcher : {"watcher", "witness"})
      EXPECT_EQ(sight(watcher).torn, 0U);
    EXPECT_TRUE(eventually([&] { return deployments().size() == target.deployments.size(); }));
  }
  EXPECT_GE(in_transitions_, rounds / 2) << "kills came too early or too late";
}

}  // namespace
}  // namespace segue::testing
