// SPDX-License-Identifier: Apache-2.0
// SIGKILL of a deployment process: while nothing happens, with samples in flight, and before every action of
// a transition in turn.
#include <atomic>
#include <csignal>

#include "deployed_robot.hpp"

namespace segue::testing {
namespace {

using runtime::EventKind;
using runtime::Outcome;

constexpr const char* kRelay =
    "  relay: {component: \"fault::Relay\"}\n  sink: {component: \"fault::Watcher\"}\n";
constexpr const char* kWork = "  work: {tasks: [relay]}\n";
constexpr const char* kFlow =
    "  - {from: beater.out, to: relay.in, policy: buffer, size: 100}\n"
    "  - {from: relay.out, to: sink.in, policy: buffer, size: 100}\n";

using KilledDeployment = DeployedRobotTest;

TEST_F(KilledDeployment, is_told_and_replaced_by_the_next_switch_while_others_go_on) {
  const auto working = network("working", kRelay, kWork, kFlow);
  switch_to(working);
  const auto before = deployments();
  ASSERT_EQ(before.size(), 3U);
  kill("work");
  expect_event(EventKind::Process, "SIGKILL");
  EXPECT_TRUE(eventually([&] { return host().observe().find_task(model::TaskId("relay")) == nullptr; }));
  EXPECT_FALSE(runtime().observed_differences().empty());
  expect_undisturbed();
  recover_to(working);
  expect_undisturbed();
  expect_undisturbed("witness");
  EXPECT_GT(pid_of("work"), 0);
  EXPECT_NE(pid_of("work"), before.at("work"));
  EXPECT_EQ(pid_of("heart"), before.at("heart"));
  EXPECT_EQ(pid_of("eye"), before.at("eye"));
  EXPECT_TRUE(eventually([&] { return sight("sink").beats > 0; }));
}

TEST_F(KilledDeployment, leaves_its_peers_whole_with_samples_in_flight) {
  const auto working = network("working", kRelay, kWork, kFlow);
  switch_to(working);
  for (const std::string victim : {"heart", "work", "eye", "heart", "eye", "work"}) {
    ASSERT_TRUE(eventually([&] { return sight().beats > 3 && sight().words > 3; }));
    kill(victim);
    recover_to(working);
    ASSERT_TRUE(eventually([&, last = sight("sink").beats] { return sight("sink").beats > last + 5; }))
        << victim;
    for (const auto* watcher : {"watcher", "witness", "sink"}) {
      EXPECT_EQ(sight(watcher).torn, 0U) << watcher << " after the death of " << victim;
    }
  }
}

TEST_F(KilledDeployment, gives_back_what_it_held) {
  const auto working = network("working", kRelay, kWork, kFlow);
  switch_to(working);
  kill("work");
  recover_to(working);
  expect_undisturbed();
  const pid_t heart = pid_of("heart");
  const Holdings before = holdings_of(heart);
  const Holdings own = holdings_of(::getpid());
  for (int i = 0; i < 5; ++i) {
    kill("work");
    recover_to(working);
    expect_undisturbed();
  }
  EXPECT_TRUE(eventually([&] { return holdings_of(heart) == before; }))
      << to_string(before) << " have become " << to_string(holdings_of(heart));
  EXPECT_TRUE(eventually([&] { return holdings_of(::getpid()) == own; }))
      << to_string(own) << " have become " << to_string(holdings_of(::getpid()));
}

TEST_F(KilledDeployment, all_at_once_is_survived) {
  const auto working = network("working", kRelay, kWork, kFlow);
  switch_to(working);
  for (const auto& [name, pid] : deployments())
    ::kill(pid, SIGKILL);
  EXPECT_TRUE(eventually([&] { return deployments().empty(); }));
  recover_to(working);
  EXPECT_EQ(deployments().size(), 3U);
}

/// Before which action, and who.
class KilledDuringTransition : public DeployedRobotTest {
 protected:
  /// The second network keeps the chain, reconfigures the relay, moves `extra` to another process and lays
  /// more connections.
  const model::Network one_ = network("one", std::string(kRelay) + "  extra: {component: \"fault::Relay\"}\n",
                                      std::string(kWork) + "  old: {tasks: [extra]}\n",
                                      std::string(kFlow) + "  - beater.out -> extra.in\n");
  const model::Network two_ =
      network("two",
              "  relay: {component: \"fault::Relay\", properties: {gain: 2}}\n"
              "  sink: {component: \"fault::Watcher\"}\n  extra: {component: \"fault::Relay\"}\n",
              std::string(kWork) + "  fresh: {tasks: [extra]}\n",
              std::string(kFlow) + "  - beater.out -> extra.in\n  - extra.out -> sink.in\n");

  /// Goes from one to two and kills `victim` before the action of that number. Answers how many actions
  /// there were.
  std::size_t go(const std::string& victim, std::size_t kill_before) {
    const auto plan = runtime().plan(two_);
    EXPECT_TRUE(plan);
    std::atomic<std::size_t> begun{0};
    life_->asking().ask([&](const model::Action&) -> Result<void> {
      if (begun++ == kill_before && pid_of(victim) > 0) ::kill(pid_of(victim), SIGKILL);
      return {};
    });
    const auto result = try_switch(two_);
    life_->asking().ask(nullptr);
    expect_no_secret_mixture(result);
    return plan->actions.size();
  }
  /// The one, or the other, or the runtime says that it is neither.
  void expect_no_secret_mixture(const runtime::SwitchResult& result) {
    const auto observed = host().observe();
    const bool restored = result.undo && result.undo->restored;
    const auto& claimed = result.outcome == Outcome::Done ? two_ : one_;
    if ((result.outcome == Outcome::Done || restored) && equivalent(observed, claimed)) return;
    const bool told =
        !runtime().observed_differences().empty() || runtime().state() == runtime::RuntimeState::Failed;
    EXPECT_TRUE(told) << to_string(result.outcome) << (result.error ? to_string(*result.error) : "") << '\n'
                      << ::testing::PrintToString(differences(claimed, observed));
  }
  void kill_before_every_action(const std::string& victim) {
    std::size_t actions = 1;
    for (std::size_t i = 0; i < actions; ++i) {
      SCOPED_TRACE(victim + " killed before action " + std::to_string(i));
      recover_to(one_);
      actions = go(victim, i);
      recover_to(two_);
    }
    EXPECT_GT(actions, 10U);
  }
};

TEST_F(KilledDuringTransition, of_a_task_that_is_reconfigured) {
  kill_before_every_action("work");
  expect_undisturbed();
}

TEST_F(KilledDuringTransition, that_is_to_go) {
  kill_before_every_action("old");
  expect_undisturbed();
}

TEST_F(KilledDuringTransition, that_has_just_come) {
  kill_before_every_action("fresh");
  expect_undisturbed();
}

TEST_F(KilledDuringTransition, that_the_transition_connects_only) {
  kill_before_every_action("heart");
  EXPECT_EQ(sight().torn, 0U);
}

}  // namespace
}  // namespace segue::testing
