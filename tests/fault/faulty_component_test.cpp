// SPDX-License-Identifier: Apache-2.0
// A component with a faulty hook, which throws, hangs, stops or ends its process, or exhausts its memory.
#include "deployed_robot.hpp"

#include <support/sanitizers.hpp>

namespace segue::testing {
namespace {

using runtime::EventKind;
using runtime::Outcome;

struct Fault {
  const char* hook;
  const char* how;
};

constexpr const char* kLimits = kSanitized ? "{core: 0}" : "{memory: 400MB, core: 0}";

std::string name_of(const ::testing::TestParamInfo<Fault>& fault) {
  return std::string(fault.param.how) + "_in_" + fault.param.hook;
}

class FaultyComponent : public DeployedRobotTest, public ::testing::WithParamInterface<Fault> {
 protected:
  /// The chain, and a task with the fault in a process of its own beside a healthy one.
  static model::Network with(const std::string& hook, const std::string& how,
                             const std::string& reached = {}) {
    return network("faulty",
                   "  bad: {component: \"fault::Faulty\", properties: {hook: \"" + hook + "\", how: " + how +
                       ", reached: \"" + reached + "\"}}\n",
                   std::string("  bad: {tasks: [bad], limits: ") + kLimits + "}\n");
  }
  const model::Network plain_ = network("plain");
  const model::Network healthy_ = with("", "nothing");
};

/// Hooks that do not return, and processes that stop altogether.
class Hang : public FaultyComponent {};

TEST_P(Hang, CostsItsProcessAndNothingElse) {
  const Duration patience = std::chrono::seconds(3);  // also for a new process on a busy computer
  switch_to(plain_);
  const std::string hook = GetParam().hook;
  const bool at_the_begin = hook == "configure" || hook == "start";
  const bool at_any_time =
      hook == "update" && std::string(GetParam().how) == "freeze";  // also before it answered
  const auto reached = folder_ / "reached";
  const auto faulty = with(hook, GetParam().how, reached);
  const auto there = at_the_begin || at_any_time ? try_switch(faulty, patience) : try_switch(faulty);
  if (!at_any_time) {
    EXPECT_EQ(there.outcome, at_the_begin ? Outcome::Failed : Outcome::Done) << there.why();
  }
  if (at_the_begin) {
    ASSERT_TRUE(there.undo);
    EXPECT_TRUE(there.undo->restored) << to_string(*there.error);
    EXPECT_EQ(pid_of("bad"), -1);
    EXPECT_TRUE(equivalent(host().observe(), plain_));
  }
  if (hook == "update") {
    ASSERT_TRUE(eventually([&] { return std::filesystem::exists(reached); }));
  }
  const pid_t hanging = pid_of("bad");
  // A process that does not answer is replaced at once; a hook is given its deadline first.
  if (at_the_begin) {
    expect_event(EventKind::ActionFailed, "bad");
  } else {
    const auto away = try_switch(plain_, patience);
    EXPECT_EQ(away.outcome, Outcome::Done) << away.why();
  }
  expect_event(EventKind::TaskState, "bad: fatal");
  expect_undisturbed();
  recover_to(healthy_);
  EXPECT_GT(pid_of("bad"), 0);
  EXPECT_NE(pid_of("bad"), hanging);
  recover_to(plain_);
  EXPECT_EQ(pid_of("bad"), -1);
  expect_undisturbed();
  expect_undisturbed("witness");
}

INSTANTIATE_TEST_SUITE_P(All, Hang,
                         ::testing::Values(Fault{"configure", "hang"}, Fault{"start", "hang"},
                                           Fault{"update", "hang"}, Fault{"stop", "hang"},
                                           Fault{"cleanup", "hang"}, Fault{"configure", "freeze"},
                                           Fault{"update", "freeze"}, Fault{"stop", "freeze"}),
                         name_of);

/// A process that stops answering in the middle of a transition, whose actions may take a minute.
class Silence : public FaultyComponent {};

TEST_P(Silence, EndsTheTransitionLongBeforeItsDeadline) {
  switch_to(plain_);
  const auto there = try_switch(with(GetParam().hook, GetParam().how), std::chrono::minutes(1));
  EXPECT_EQ(there.outcome, Outcome::Failed);
  ASSERT_TRUE(there.error);
  EXPECT_NE(to_string(*there.error).find("does not answer"), std::string::npos) << to_string(*there.error);
  EXPECT_LT(there.duration, std::chrono::seconds(20));
  EXPECT_TRUE(there.undo && there.undo->restored);
  EXPECT_EQ(pid_of("bad"), -1);
  expect_undisturbed();
}

INSTANTIATE_TEST_SUITE_P(All, Silence,
                         ::testing::Values(Fault{"configure", "freeze"}, Fault{"start", "freeze"}), name_of);

/// Exceptions and refusals: the process stays.
class Failure : public FaultyComponent {};

TEST_P(Failure, IsReportedAndTheProcessStays) {
  switch_to(healthy_);
  const pid_t pid = pid_of("bad");
  const std::string hook = GetParam().hook;
  const auto there = try_switch(with(hook, GetParam().how));
  if (hook == "configure" || hook == "start") {
    EXPECT_EQ(there.outcome, Outcome::Failed);
    expect_event(EventKind::ActionFailed, "bad");
  } else if (hook == "update") {
    expect_event(EventKind::TaskState, "thrown, as requested");
  } else {
    EXPECT_EQ(try_switch(plain_).outcome, Outcome::Done) << "a removed task does not block the switch";
    expect_event(EventKind::ActionFailed, "thrown, as requested");
    EXPECT_TRUE(eventually([&] { return pid_of("bad") == -1; }));
  }
  expect_undisturbed();
  const bool stays = pid_of("bad") == pid;
  EXPECT_EQ(stays, hook != "stop" && hook != "cleanup");
  recover_to(healthy_);
  EXPECT_EQ(pid_of("bad") == pid, stays);
  expect_undisturbed();
}

INSTANTIATE_TEST_SUITE_P(All, Failure,
                         ::testing::Values(Fault{"configure", "throw"}, Fault{"start", "throw"},
                                           Fault{"update", "throw"}, Fault{"stop", "throw"},
                                           Fault{"cleanup", "throw"}, Fault{"configure", "error"},
                                           Fault{"start", "error"}),
                         name_of);

/// The process ends.
class Crash : public FaultyComponent {};

TEST_P(Crash, CostsItsProcessAndNothingElse) {
  switch_to(healthy_);
  const pid_t pid = pid_of("bad");
  const std::string hook = GetParam().hook;
  const auto there = try_switch(with(hook, GetParam().how));
  if (hook != "update") {
    const auto outcome = hook == "stop" ? try_switch(plain_).outcome : there.outcome;
    EXPECT_EQ(outcome, hook == "stop" ? Outcome::Done : Outcome::Failed);
  }
  EXPECT_TRUE(eventually([&] { return pid_of("bad") != pid; }));
  const std::string how = GetParam().how;
  expect_event(EventKind::Process, how == "abort" ? "SIGABRT" : how == "crash" ? "SIGSEGV" : "status 3");
  expect_undisturbed();
  recover_to(healthy_);
  EXPECT_GT(pid_of("bad"), 0);
  expect_undisturbed();
}

INSTANTIATE_TEST_SUITE_P(All, Crash,
                         ::testing::Values(Fault{"configure", "abort"}, Fault{"update", "abort"},
                                           Fault{"stop", "abort"}, Fault{"start", "crash"},
                                           Fault{"update", "exit"}),
                         name_of);

#if !defined(SEGUE_SANITIZER_ADDRESS) && \
    !defined(SEGUE_SANITIZER_THREAD)  // with them there is no limit to reach

class Exhaustion : public FaultyComponent {};

TEST_P(Exhaustion, OfMemoryAffectsNoOtherProcess) {
  switch_to(plain_);
  const std::string hook = GetParam().hook;
  const auto there = try_switch(with(hook, GetParam().how));
  if (hook == "configure") {
    EXPECT_EQ(there.outcome, Outcome::Failed);
  } else {
    expect_event(EventKind::TaskState, "bad_alloc");
  }
  expect_undisturbed();
  recover_to(healthy_);
  recover_to(plain_);
  expect_undisturbed();
}

INSTANTIATE_TEST_SUITE_P(All, Exhaustion,
                         ::testing::Values(Fault{"configure", "exhaust"}, Fault{"update", "exhaust"}),
                         name_of);

#endif

}  // namespace
}  // namespace segue::testing
