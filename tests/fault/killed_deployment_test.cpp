// SPDX-License-Identifier: Apache-2.0
// SIGKILL of a deployment process: while idle, with samples in flight, and before every action of a
// transition in turn.
#include <atomic>
#include <csignal>

#include "disturbed_transition.hpp"

namespace segue::testing {
namespace {

using runtime::EventKind;
using runtime::Outcome;

using KilledDeployment = DeployedRobotTest;

TEST_F(KilledDeployment, IsReportedAndReplacedByTheNextSwitchWhileOthersContinue) {
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

TEST_F(KilledDeployment, LeavesItsPeersWholeWithSamplesInFlight) {
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

TEST_F(KilledDeployment, ReleasesItsResources) {
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
  EXPECT_TRUE(eventually([&] { return !has_grown(before, holdings_of(heart)); }))
      << to_string(before) << " have become " << to_string(holdings_of(heart));
  EXPECT_TRUE(eventually([&] { return !has_grown(own, holdings_of(::getpid())); }))
      << to_string(own) << " have become " << to_string(holdings_of(::getpid()));
}

TEST_F(KilledDeployment, AllAtOnceIsSurvived) {
  const auto working = network("working", kRelay, kWork, kFlow);
  switch_to(working);
  for (const auto& [name, pid] : deployments())
    ::kill(pid, SIGKILL);
  EXPECT_TRUE(eventually([&] { return deployments().empty(); }));
  recover_to(working);
  EXPECT_EQ(deployments().size(), 3U);
}

class KilledDuringTransition : public DisturbedTransition {
 protected:
  void kill_before_every_action(const std::string& victim) {
    std::atomic<int> kills{0};
    before_every_action("kill " + victim, [&](std::size_t) {
      if (const pid_t pid = pid_of(victim); pid > 0) kills += ::kill(pid, SIGKILL) == 0 ? 1 : 0;
    });
    EXPECT_GT(kills, 3) << "the process exists before many of the actions";
  }
};

TEST_F(KilledDuringTransition, OfATaskThatIsReconfigured) {
  kill_before_every_action("work");
  expect_undisturbed();
}

TEST_F(KilledDuringTransition, ThatIsRemoved) {
  kill_before_every_action("old");
  expect_undisturbed();
}

TEST_F(KilledDuringTransition, ThatHasJustBeenDeployed) {
  kill_before_every_action("fresh");
  expect_undisturbed();
}

TEST_F(KilledDuringTransition, ThatTheTransitionOnlyConnects) {
  kill_before_every_action("heart");
  EXPECT_EQ(sight().torn, 0U);
}

}  // namespace
}  // namespace segue::testing
