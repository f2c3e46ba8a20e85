// SPDX-License-Identifier: Apache-2.0
#include <segue/task/probe_component.hpp>

#include <gmock/gmock.h>

#include <array>
#include <map>
#include <tuple>

namespace segue::task {
namespace {

using test::soon;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using Hooks = std::vector<std::string>;
using Verb = Result<void> (Task::*)(Deadline);

struct VerbCase {
  std::string name;
  Verb verb;
};

const std::array<VerbCase, 5> kVerbs = {{{"configure", &Task::configure},
                                         {"start", &Task::start},
                                         {"stop", &Task::stop},
                                         {"cleanup", &Task::cleanup},
                                         {"recover", &Task::recover}}};

struct Edge {
  TaskState from;
  std::string verb;
  TaskState to;
  Hooks hooks;
};

/// All legal pairs of state and verb; every other pair is illegal.
const std::vector<Edge> kEdges = {{TaskState::PreOperational, "configure", TaskState::Stopped, {"configure"}},
                                  {TaskState::Stopped, "start", TaskState::Running, {"start"}},
                                  {TaskState::Running, "stop", TaskState::Stopped, {"stop"}},
                                  {TaskState::RunTimeError, "stop", TaskState::Stopped, {"stop"}},
                                  {TaskState::Stopped, "cleanup", TaskState::PreOperational, {"cleanup"}},
                                  {TaskState::RunTimeError, "recover", TaskState::Running, {"recover"}},
                                  {TaskState::Exception, "recover", TaskState::PreOperational, {"recover"}}};

const Edge* find_edge(TaskState from, const std::string& verb) {
  for (const Edge& edge : kEdges) {
    if (edge.from == from && edge.verb == verb) return &edge;
  }
  return nullptr;
}

class LifeCycleEdge : public test::TaskTest,
                      public ::testing::WithParamInterface<std::tuple<std::size_t, std::size_t>> {
 protected:
  TaskState from() const { return static_cast<TaskState>(std::get<0>(GetParam())); }
  const VerbCase& verb() const { return kVerbs.at(std::get<1>(GetParam())); }
  Result<void> perform() { return ((*task).*verb().verb)(soon()); }
};

class LegalEdge : public test::TaskTest, public ::testing::WithParamInterface<Edge> {
 protected:
  TaskState from() const { return GetParam().from; }
  Result<void> perform() {
    for (const VerbCase& one : kVerbs) {
      if (one.name == GetParam().verb) return ((*task).*one.verb)(soon());
    }
    return fail(ErrorCode::NotFound, "no such verb");
  }
};

TEST_P(LifeCycleEdge, LegalOnesRunTheirHookAndIllegalOnesChangeNothing) {
  bring_to(from());
  const Result<void> done = perform();
  const Edge* edge = find_edge(from(), verb().name);
  if (edge != nullptr) {
    EXPECT_TRUE(done) << to_string(done.error());
    EXPECT_EQ(task->state(), edge->to);
    EXPECT_EQ(probe->hooks, edge->hooks);
    return;
  }
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::InvalidState);
  EXPECT_THAT(done.error().message, HasSubstr(task->state_name()));
  EXPECT_EQ(task->state(), from());
  EXPECT_THAT(probe->hooks, IsEmpty());
}

TEST_P(LegalEdge, HookThatRefusesLeavesTheStateBeforeIfItCan) {
  bring_to(from());
  if (GetParam().verb == "stop" || GetParam().verb == "cleanup") {
    EXPECT_TRUE(perform()) << "these hooks have no way to refuse";
    return;
  }
  probe->act = [](const std::string&) -> Result<void> { return fail(ErrorCode::IoError, "no device"); };
  const Result<void> done = perform();
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::HookFailed);
  ASSERT_NE(done.error().cause, nullptr);
  EXPECT_EQ(done.error().cause->message, "no device");
  EXPECT_EQ(task->state(), from());
  probe->act = [](const std::string&) -> Result<void> { return {}; };
  EXPECT_TRUE(perform()) << "the verb works once its hook does";
}

TEST_P(LegalEdge, HookThatThrowsEndsInExceptionWithEverythingUndone) {
  bring_to(from());
  const std::string hook = GetParam().hooks.front();
  probe->act = [&](const std::string& running) -> Result<void> {
    if (running == hook) throw std::runtime_error("lightning");
    return {};
  };
  const Result<void> done = perform();
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::HookFailed);
  EXPECT_EQ(task->state(), TaskState::Exception);
  EXPECT_THAT(task->error_message(), HasSubstr("lightning"));
  const std::map<std::string, Hooks> undone = {{"configure", {"configure", "cleanup"}},
                                               {"start", {"start", "stop", "cleanup"}},
                                               {"stop", {"stop", "cleanup"}},
                                               {"cleanup", {"cleanup"}},
                                               {"recover", {"recover"}}};
  if (from() == TaskState::RunTimeError && hook == "recover") {
    EXPECT_EQ(probe->hooks, (Hooks{"recover", "stop", "cleanup"}));
  } else {
    EXPECT_EQ(probe->hooks, undone.at(hook));
  }
}

std::string edge_name(const ::testing::TestParamInfo<std::tuple<std::size_t, std::size_t>>& info) {
  return std::string(kTaskStateNames.at(std::get<0>(info.param))) + "_" +
         kVerbs.at(std::get<1>(info.param)).name;
}

INSTANTIATE_TEST_SUITE_P(All, LifeCycleEdge,
                         ::testing::Combine(::testing::Range<std::size_t>(0, 6),
                                            ::testing::Range<std::size_t>(0, 5)),
                         edge_name);

INSTANTIATE_TEST_SUITE_P(All, LegalEdge, ::testing::ValuesIn(kEdges), [](const auto& edge) {
  return std::string(to_string(edge.param.from)) + "_" + edge.param.verb;
});

using LifeCycle = test::TaskTest;

TEST_F(LifeCycle, UpdateThatThrowsIsStoppedAndCleanedUp) {
  bring_to(TaskState::Running);
  probe->act = [](const std::string& hook) -> Result<void> {
    if (hook == "update") throw std::runtime_error("lightning");
    return {};
  };
  update();
  EXPECT_EQ(task->state(), TaskState::Exception);
  EXPECT_EQ(task->error_message(), "on_update threw: lightning");
  EXPECT_THAT(probe->hooks, ElementsAre("update", "stop", "cleanup"));
  update();
  EXPECT_THAT(probe->hooks, ElementsAre("update", "stop", "cleanup")) << "an exception updates no more";
}

TEST_F(LifeCycle, UndoingHooksThatThrowTooDoNotEndTheProcess) {
  bring_to(TaskState::Running);
  probe->act = [](const std::string&) -> Result<void> { throw 42; };
  update();
  EXPECT_EQ(task->state(), TaskState::Exception);
  EXPECT_THAT(probe->hooks, ElementsAre("update", "stop", "cleanup"));
  EXPECT_THAT(task->error_message(), HasSubstr("on_update threw"));
}

TEST_F(LifeCycle, FatalRunsNoFurtherHookAndIsNeverLeft) {
  bring_to(TaskState::Running);
  probe->act = [this](const std::string&) -> Result<void> {
    probe->fatal("arm detached");
    return {};
  };
  update();
  EXPECT_EQ(task->state(), TaskState::Fatal);
  EXPECT_THAT(probe->hooks, ElementsAre("update"));
  EXPECT_EQ(task->error_message(), "arm detached");
  task.reset();
}

TEST_F(LifeCycle, ErrorCallsOnErrorUntilTheComponentRecovers) {
  bring_to(TaskState::Running);
  probe->act = [this](const std::string& hook) -> Result<void> {
    if (hook == "update") probe->error(probe->too_hot, "81 degrees");
    return {};
  };
  update();
  EXPECT_EQ(task->state(), TaskState::RunTimeError);
  EXPECT_EQ(task->state_name(), "TOO_HOT");
  EXPECT_EQ(task->error_message(), "81 degrees");
  update();
  probe->act = [this](const std::string& hook) -> Result<void> {
    if (hook == "error") probe->recovered();
    return {};
  };
  update();
  EXPECT_EQ(task->state(), TaskState::Running);
  EXPECT_EQ(task->error_message(), "");
  update();
  EXPECT_THAT(probe->hooks, ElementsAre("update", "error", "error", "update"));
}

TEST_F(LifeCycle, ErrorInOnStartStartsInRunTimeErrorAndSaysSo) {
  bring_to(TaskState::Stopped);
  probe->act = [this](const std::string&) -> Result<void> {
    probe->error(probe->sensor_lost, "no echo");
    return {};
  };
  const Result<void> started = task->start(soon());
  ASSERT_FALSE(started);
  EXPECT_THAT(started.error().message, HasSubstr("no echo"));
  EXPECT_EQ(task->state_name(), "SENSOR_LOST");
}

TEST_F(LifeCycle, SubStateLastsUntilAnotherOneIsEntered) {
  bring_to(TaskState::Running);
  const auto after = [this](const State& state) {
    probe->act = [&state](const std::string&) -> Result<void> {
      state.enter();
      return {};
    };
    update();
    return task->state_name();
  };
  EXPECT_EQ(after(probe->tracking), "TRACKING");
  EXPECT_EQ(task->state(), TaskState::Running);
  EXPECT_EQ(after(probe->settling), "SETTLING");
}

TEST_F(LifeCycle, SubStateOfOnStartIsThatInWhichRunningBegins) {
  bring_to(TaskState::Stopped);
  probe->act = [this](const std::string& hook) -> Result<void> {
    if (hook == "start") probe->tracking.enter();
    return {};
  };
  ASSERT_TRUE(task->start(soon()));
  EXPECT_EQ(task->state_name(), "TRACKING");
  ASSERT_TRUE(task->stop(soon()));
  probe->act = [](const std::string&) { return Result<void>(); };
  ASSERT_TRUE(task->start(soon()));
  EXPECT_EQ(task->state_name(), "running") << "it is that of one start";
}

TEST_F(LifeCycle, SubStateIsNotEnteredOutsideOfRunning) {
  bring_to(TaskState::Stopped);
  probe->tracking.enter();
  EXPECT_EQ(task->state_name(), "stopped");
}

TEST_F(LifeCycle, EveryChangeIsToldToTheListenerInOrder) {
  std::vector<TaskState> heard;
  task->set_state_listener([&](const Task& changed, TaskState state) {
    EXPECT_EQ(changed.state(), state);
    heard.push_back(state);
  });
  ASSERT_TRUE(task->configure(soon()));
  ASSERT_TRUE(task->start(soon()));
  probe->act = [this](const std::string& hook) -> Result<void> {
    if (hook == "update") probe->exception("broken");
    return {};
  };
  update();
  ASSERT_TRUE(task->recover(soon()));
  EXPECT_THAT(heard, ElementsAre(TaskState::Stopped, TaskState::Running, TaskState::Exception,
                                 TaskState::PreOperational));
}

TEST_F(LifeCycle, VerbFromInsideAHookIsRefusedInsteadOfDeadlocking) {
  bring_to(TaskState::Running);
  Result<void> stopped;
  probe->act = [&](const std::string& hook) -> Result<void> {
    if (hook == "update") stopped = task->stop(soon());
    return {};
  };
  update();
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::InvalidState);
  EXPECT_EQ(task->state(), TaskState::Running);
}

TEST_F(LifeCycle, DestructionStopsAndCleansUp) {
  bring_to(TaskState::Running);
  std::vector<std::string> hooks;
  probe->act = [&](const std::string& hook) -> Result<void> {
    hooks.push_back(hook);
    throw std::runtime_error("even if it throws");
  };
  task.reset();
  EXPECT_THAT(hooks, ElementsAre("stop", "cleanup"));
}

TEST_F(LifeCycle, DestructionStopsATaskInARunTimeErrorToo) {
  bring_to(TaskState::RunTimeError);
  std::vector<std::string> hooks;
  probe->act = [&](const std::string& hook) -> Result<void> {
    hooks.push_back(hook);
    return {};
  };
  task.reset();
  EXPECT_THAT(hooks, ElementsAre("stop", "cleanup"));
}

TEST_F(LifeCycle, RenewedTaskHasItsComponentAndTheOldOneRetires) {
  ASSERT_TRUE(task->set_properties(type::Value::map({{"gain", 4.0}}), soon()));
  const Activity slow{Trigger::Periodic, std::chrono::seconds(1), {}, 0, {}, {}, false};
  auto renewed = Task::renew(*task, slow, executor, soon());
  ASSERT_TRUE(renewed) << to_string(renewed.error());
  EXPECT_EQ(&(*renewed)->component(), probe);
  EXPECT_EQ(*(*renewed)->properties().find("gain"), 4.0);
  EXPECT_EQ((*renewed)->activity(), slow);
  const auto refused = task->configure(soon());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::InvalidState);
  EXPECT_THAT(refused.error().message, HasSubstr("replaced"));
  ASSERT_TRUE((*renewed)->configure(soon()));
  ASSERT_TRUE((*renewed)->start(soon()));
  task.reset();
  executor->run_ready();
  EXPECT_THAT(probe->hooks, ElementsAre("configure", "start", "update"));
  EXPECT_EQ(probe->id(), "probe") << "what retires leaves the component alone";
  ASSERT_FALSE(Task::renew(**renewed, slow, executor, soon())) << "only in pre_operational";
}

TEST_F(LifeCycle, UpdatesOnlyWhileRunning) {
  bring_to(TaskState::Stopped);
  update();
  EXPECT_THAT(probe->hooks, IsEmpty());
  ASSERT_TRUE(task->start(soon()));
  InputPortAccess::notify(probe->input);
  ASSERT_TRUE(task->stop(soon()));
  executor->run_ready();
  EXPECT_THAT(probe->hooks, ElementsAre("start", "stop")) << "a trigger from before the stop is void";
}

TEST_F(LifeCycle, MissingTriggerPortRefusesTheStart) {
  struct Wrong : test::Probe {
    Wrong() : Probe({.trigger_on = {"inptu"}}) {}
  };
  auto made = Task::create("wrong", std::make_unique<Wrong>(), Activity{}, executor);
  ASSERT_TRUE(made);
  ASSERT_TRUE((*made)->configure(soon()));
  const Result<void> started = (*made)->start(soon());
  ASSERT_FALSE(started);
  EXPECT_THAT(started.error().message, HasSubstr("did you mean 'input'"));
  EXPECT_EQ((*made)->state(), TaskState::Stopped);
}

TEST_F(LifeCycle, TwoPortsOfOneNameAreRefused) {
  struct Twice : test::Probe {
    InputPort<int> again{*this, "input"};
  };
  auto made = Task::create("twice", std::make_unique<Twice>(), Activity{}, executor);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::AlreadyExists);
}

TEST_F(LifeCycle, PeriodOfZeroIsRefused) {
  auto made =
      Task::create("zero", std::make_unique<test::Probe>(), Activity{.trigger = Trigger::Periodic}, executor);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::InvalidArgument);
}

class HandOverTest : public test::TaskTest {
 protected:
  static inline const SavedState kState{"/probe/Count", 2, type::Value(7)};
};

TEST_F(HandOverTest, TheStateOfAStoppedTaskIsSaved) {
  probe->saved = kState;
  bring_to(TaskState::Stopped);
  const auto state = task->save_state(soon());
  ASSERT_TRUE(state) << to_string(state.error());
  EXPECT_EQ(*state, kState);
  EXPECT_THAT(probe->hooks, ElementsAre("save_state"));
  EXPECT_EQ(task->state(), TaskState::Stopped);
}

TEST_F(HandOverTest, WhoeverRemembersNothingHandsNothingOver) {
  bring_to(TaskState::Stopped);
  const auto state = task->save_state(soon());
  ASSERT_TRUE(state);
  EXPECT_FALSE(state->has_value());
}

TEST_F(HandOverTest, ATaskThatIsNotStoppedNeitherGivesNorTakes) {
  for (const TaskState state : {TaskState::PreOperational, TaskState::Running}) {
    make({.trigger = Trigger::PortDriven});
    bring_to(state);
    EXPECT_EQ(task->save_state(soon()).error().code, ErrorCode::InvalidState);
    EXPECT_EQ(task->restore_state(kState, soon()).error().code, ErrorCode::InvalidState);
    EXPECT_THAT(probe->hooks, IsEmpty());
  }
}

TEST_F(HandOverTest, SavingThatThrowsLeavesATaskThatCanGoOn) {
  bring_to(TaskState::Stopped);
  probe->act = [](const std::string&) -> Result<void> { throw std::runtime_error("no memory of it"); };
  const auto state = task->save_state(soon());
  ASSERT_FALSE(state);
  EXPECT_EQ(state.error().code, ErrorCode::HookFailed);
  EXPECT_THAT(state.error().message, HasSubstr("no memory of it"));
  EXPECT_EQ(task->state(), TaskState::Stopped);
  probe->act = [](const std::string&) -> Result<void> { return {}; };
  EXPECT_TRUE(task->start(soon()));
}

TEST_F(HandOverTest, SavingThatAsksForFatalGetsIt) {
  bring_to(TaskState::Stopped);
  probe->act = [this](const std::string&) -> Result<void> {
    probe->fatal("memory is corrupt");
    return {};
  };
  EXPECT_FALSE(task->save_state(soon()));
  EXPECT_EQ(task->state(), TaskState::Fatal);
}

TEST_F(HandOverTest, AStateIsRestoredBeforeTheStart) {
  bring_to(TaskState::Stopped);
  ASSERT_TRUE(task->restore_state(kState, soon()));
  EXPECT_EQ(probe->restored, kState);
  EXPECT_EQ(task->state(), TaskState::Stopped);
  ASSERT_TRUE(task->start(soon()));
  EXPECT_THAT(probe->hooks, ElementsAre("restore_state", "start"));
}

TEST_F(HandOverTest, AStateThatIsRefusedLeavesTheTaskStopped) {
  bring_to(TaskState::Stopped);
  probe->act = [](const std::string&) -> Result<void> {
    return fail(ErrorCode::TypeMismatch, "version 3 is needed");
  };
  const auto done = task->restore_state(kState, soon());
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::HookFailed);
  EXPECT_THAT(to_string(done.error()), HasSubstr("version 3 is needed"));
  EXPECT_EQ(task->state(), TaskState::Stopped);
}

TEST_F(HandOverTest, RestoringThatThrowsCleansUp) {
  bring_to(TaskState::Stopped);
  probe->act = [](const std::string& hook) -> Result<void> {
    if (hook == "restore_state") throw std::runtime_error("half of it is missing");
    return {};
  };
  EXPECT_FALSE(task->restore_state(kState, soon()));
  EXPECT_EQ(task->state(), TaskState::Exception);
  EXPECT_THAT(probe->hooks, ElementsAre("restore_state", "cleanup"));
}

TEST_F(HandOverTest, AComponentThatKnowsNoStateRefusesEveryOne) {
  class Plain final : public Component {};
  auto made = Task::create("plain", std::make_unique<Plain>(), Activity{}, executor);
  ASSERT_TRUE(made);
  ASSERT_TRUE((*made)->configure(soon()));
  const auto none = (*made)->save_state(soon());
  ASSERT_TRUE(none);
  EXPECT_FALSE(none->has_value());
  const auto done = (*made)->restore_state(kState, soon());
  ASSERT_FALSE(done);
  EXPECT_THAT(to_string(done.error()), HasSubstr("'/probe/Count' version 2"));
}

TEST(SavedState, OfATypeCarriesItsNameAndVersion) {
  const SavedState state = make_state(std::vector<double>{1.5, 2.0}, 3);
  EXPECT_EQ(state.version, 3U);
  const auto read = read_state<std::vector<double>>(state, 3);
  ASSERT_TRUE(read) << to_string(read.error());
  EXPECT_THAT(*read, ElementsAre(1.5, 2.0));
}

TEST(SavedState, OfAnotherTypeOrVersionIsRefused) {
  const SavedState state = make_state(std::vector<double>{1.5}, 1);
  const auto newer = read_state<std::vector<double>>(state, 2);
  ASSERT_FALSE(newer);
  EXPECT_EQ(newer.error().code, ErrorCode::TypeMismatch);
  EXPECT_THAT(newer.error().message, HasSubstr("version 2, got"));
  EXPECT_FALSE(read_state<int>(state));
  EXPECT_FALSE(read_state<std::vector<double>>(SavedState{state.name, 1, type::Value("text")}));
}

}  // namespace
}  // namespace segue::task
