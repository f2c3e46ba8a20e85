// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/instance_calls.hpp>
#include <segue/task_host/local_task_host.hpp>

#include <support/forwarding_host.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace segue::runtime::detail {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Key;

using End = InstanceCalls::End;
const InstanceCalls::Life kPlanner{model::TaskId("planner_1"), 7};

/// Of a host that has no tasks.
class CallsOfInstances : public ::testing::Test {
 protected:
  CallsOfInstances() { calls.starts(kPlanner.instance); }

  model::ComponentCatalog catalog_;
  task_host::LibrarySet libraries_;
  task_host::LocalTaskHost host_{
      libraries_, catalog_, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}}};
  model::Network pools_;
  InstanceCalls calls{host_, pools_, [] {}};
};

TEST_F(CallsOfInstances, MakeThemBusyUntilTheyAreAnswered) {
  const auto call = calls.begin(kPlanner);
  EXPECT_TRUE(calls.is_busy(kPlanner));
  calls.ended(call, End::Answered);
  EXPECT_FALSE(calls.is_busy(kPlanner));
  EXPECT_EQ(calls.why_abandoned(kPlanner), "");
}

TEST_F(CallsOfInstances, AbandonThemWhereNobodyWaitsForTheAnswer) {
  const auto stopped = calls.begin(kPlanner);
  calls.no_longer_wanted(stopped);
  EXPECT_THAT(calls.why_abandoned(kPlanner), HasSubstr("nobody waits"));
  calls.ended(stopped, End::Answered);
  EXPECT_EQ(calls.why_abandoned(kPlanner), "") << "it was answered all the same";
  calls.ended(calls.begin(kPlanner), End::Unknown);
  EXPECT_THAT(calls.why_abandoned(kPlanner), HasSubstr("nobody waits"));
  EXPECT_EQ(calls.why_abandoned({kPlanner.instance, 8}), "") << "its next process does nothing yet";
  calls.forget(kPlanner);
  EXPECT_EQ(calls.why_abandoned(kPlanner), "");
}

TEST_F(CallsOfInstances, AbandonNoneThatHasNotBegunWithThem) {
  const auto first = calls.begin(kPlanner);
  const auto second = calls.begin(kPlanner);
  calls.ended(second, End::Unknown);
  EXPECT_EQ(calls.why_abandoned(kPlanner), "") << "it still works for who called first";
  const auto third = calls.begin(kPlanner);
  calls.no_longer_wanted(third);
  EXPECT_EQ(calls.why_abandoned(kPlanner), "");
  calls.ended(first, End::Answered);
  EXPECT_THAT(calls.why_abandoned(kPlanner), HasSubstr("nobody waits")) << "that one has begun now";
}

TEST_F(CallsOfInstances, BeginNoMoreWithOneThatIsToBeStopped) {
  const auto call = calls.begin(kPlanner);
  EXPECT_FALSE(calls.retire(kPlanner)) << "it is busy";
  calls.ended(call, End::Unknown);
  EXPECT_FALSE(calls.retire(kPlanner)) << "it may be busy still";
  calls.forget(kPlanner);
  EXPECT_TRUE(calls.retire(kPlanner));
  EXPECT_EQ(calls.begin(kPlanner), 0U);
  EXPECT_NE(calls.begin({kPlanner.instance, 8}), 0U) << "its next process takes calls";
  calls.starts(kPlanner.instance);
  EXPECT_NE(calls.begin(kPlanner), 0U) << "it is needed again, and has not been stopped";
}

/// Of a process that may have ended: a connection ends before it is known why.
class SeenHost final : public segue::testing::ForwardingHost {
 public:
  using segue::testing::ForwardingHost::ForwardingHost;
  bool is_reachable = true;
  TaskState state = TaskState::Running;
  [[nodiscard]] std::vector<task_host::TaskReport> tasks() const override {
    task_host::TaskReport report;
    report.id = kPlanner.instance;
    report.pid = kPlanner.pid;
    report.state = state;
    report.unknown = !is_reachable;
    return {report};
  }
};

TEST_F(CallsOfInstances, AreToBeEndedOnlyWhereTheirProcessesAnswer) {
  SeenHost host(host_);
  model::Network pools;
  pools.tasks.emplace_back().id = kPlanner.instance;
  InstanceCalls at_host(host, pools, [] {});
  at_host.starts(kPlanner.instance);
  at_host.no_longer_wanted(at_host.begin(kPlanner));
  EXPECT_THAT(at_host.abandoned(), ElementsAre(Key(kPlanner)));
  host.is_reachable = false;
  EXPECT_THAT(at_host.abandoned(), IsEmpty()) << "what comes of it is for the policy of the pool";
  host.is_reachable = true;
  host.state = TaskState::Fatal;
  EXPECT_THAT(at_host.abandoned(), IsEmpty()) << "its process does not answer, or has ended";
  host.state = TaskState::Running;
  EXPECT_THAT(at_host.abandoned(), ElementsAre(Key(kPlanner))) << "it has not ended";
}

TEST_F(CallsOfInstances, AbandonWhatAnEarlierRuntimeHasLeftWheneverItIsSeenFirst) {
  SeenHost host(host_);
  host.is_reachable = false;
  model::Network pools;
  pools.tasks.emplace_back().id = kPlanner.instance;
  InstanceCalls at_host(host, pools, [] {});
  EXPECT_THAT(at_host.abandoned(), IsEmpty());
  host.is_reachable = true;
  EXPECT_THAT(at_host.why_abandoned(kPlanner), HasSubstr("earlier runtime"));
  EXPECT_THAT(at_host.abandoned(), ElementsAre(Key(kPlanner)));
  at_host.starts(kPlanner.instance);
  EXPECT_THAT(at_host.abandoned(), ElementsAre(Key(kPlanner))) << "it has not been ended yet";
  EXPECT_EQ(at_host.why_abandoned({kPlanner.instance, 8}), "");
}

TEST_F(CallsOfInstances, AbandonNoneThatTheyHaveStartedOnAComputerThatComesBack) {
  SeenHost host(host_);
  model::Network pools;
  pools.tasks.emplace_back().id = kPlanner.instance;
  InstanceCalls at_host(host, pools, [] {});
  at_host.starts(kPlanner.instance);
  EXPECT_THAT(at_host.abandoned(), IsEmpty());
  host.is_reachable = false;
  EXPECT_THAT(at_host.abandoned(), IsEmpty());
  host.is_reachable = true;
  EXPECT_THAT(at_host.abandoned(), IsEmpty());
}

}  // namespace
}  // namespace segue::runtime::detail
