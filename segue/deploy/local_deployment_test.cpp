// SPDX-License-Identifier: Apache-2.0
// The tasks of one process as a deployment, without shared memory.
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/deploy/local_deployment.hpp>
#include <segue/task_host/test_support.hpp>
#include <support/eventually.hpp>
#include <support/test_hooks.hpp>

#include <gmock/gmock.h>

#include <set>
#include <thread>

SEGUE_COMPONENT(hooks::Stuck)

namespace segue::deploy {
namespace {

using model::ActionKind;
using segue::testing::eventually;
using task_host::testing::apply;
using task_host::testing::on_connection;
using task_host::testing::on_process;
using task_host::testing::on_task;
using task_host::testing::soon;
using task_host::testing::task_of;
using task_host::testing::wire;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TimePoint in(std::chrono::milliseconds time) {
  return RealClock::instance().now() + time;
}

DeploymentInfo info_of(std::string_view process) {
  DeploymentInfo info;
  info.robot = "crawler";
  info.deployment.process = model::ProcessName(process);
  info.pid = 7;
  return info;
}

model::Task stuck_in(std::string_view id, std::string_view hook) {
  return task_of(id, "hooks::Stuck", type::Value::map({{"hook", std::string(hook)}}));
}

/// With updates that are overdue after a millisecond.
model::Task overdue_in(std::string_view id, std::string_view hook) {
  model::Task task = stuck_in(id, hook);
  task.activity = Activity{.trigger = Trigger::Periodic,
                           .period = std::chrono::milliseconds(1),
                           .update_deadline = std::chrono::milliseconds(1)};
  return task;
}

class LocalDeploymentTest : public ::testing::Test {
 protected:
  LocalDeploymentTest() { hooks::reset(); }
  ~LocalDeploymentTest() override { hooks::release_all(); }

  std::vector<Result<void>> perform(const std::vector<model::Action>& actions) {
    return deployment_.perform_all(actions, soon());
  }
  /// Sequentially.
  void expect_done(const std::vector<model::Action>& actions) {
    for (const auto& action : actions) {
      const auto done = perform({action}).front();
      EXPECT_TRUE(done) << to_string(done.error());
    }
  }
  void expect_refused(const model::Action& action, ErrorCode code, std::string_view words) {
    const auto outcomes = perform({action});
    ASSERT_EQ(outcomes.size(), 1U);
    ASSERT_FALSE(outcomes.front()) << action.label();
    EXPECT_EQ(outcomes.front().error().code, code);
    EXPECT_THAT(to_string(outcomes.front().error()), HasSubstr(words));
  }
  void bring_to_running(const model::Task& task) {
    expect_done({apply(task, "p"), on_task(ActionKind::Configure, task.id.str()),
                 on_task(ActionKind::Start, task.id.str())});
  }
  TaskState state_of(std::string_view id) {
    const auto network = deployment_.snapshot()->network;
    const auto* task = network.find_task(model::TaskId(id));
    return task == nullptr ? TaskState::Fatal : task->state;
  }
  /// Waits until exactly these tasks are reported as hanging.
  [[nodiscard]] bool hang_now(const std::vector<model::TaskId>& expected) {
    return eventually([&] { return deployment_.snapshot()->hanging == expected; });
  }

  model::ComponentCatalog catalog_;
  task_host::LibrarySet libraries_;
  task_host::LocalTaskHost host_{
      libraries_, catalog_, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}}};
  LocalDeployment deployment_{info_of("p"), host_, nullptr};
};

TEST_F(LocalDeploymentTest, IsThereFromTheBeginningAndHoldsItsTasks) {
  bring_to_running(task_of("a", "any::Thing"));
  const auto snapshot = deployment_.snapshot();
  ASSERT_TRUE(snapshot);
  ASSERT_EQ(snapshot->network.deployments.size(), 1U);
  EXPECT_EQ(snapshot->network.deployments.front().process, model::ProcessName("p"));
  ASSERT_EQ(snapshot->network.deployments.front().tasks.size(), 1U);
  EXPECT_EQ(snapshot->network.deployments.front().tasks.front().task, model::TaskId("a"));
  ASSERT_EQ(snapshot->tasks.size(), 1U);
  EXPECT_EQ(snapshot->tasks.front().process.process, model::ProcessName("p"));
  EXPECT_EQ(snapshot->tasks.front().state, TaskState::Running);
  EXPECT_THAT(snapshot->hanging, IsEmpty());
  EXPECT_EQ(deployment_.info()->pid, 7);
}

TEST_F(LocalDeploymentTest, HoldsTasksOfTheRuntimeWithoutADeploymentWhereItIsTheRuntimesOwn) {
  task_host::LocalTaskHost host{
      libraries_, catalog_, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}}};
  LocalDeployment own(info_of(""), host, nullptr);
  const auto outcomes = own.perform_all(std::vector{apply(task_of("a", "any::Thing"))}, soon());
  ASSERT_TRUE(outcomes.front()) << to_string(outcomes.front().error());
  EXPECT_THAT(own.snapshot()->network.deployments, IsEmpty());
  EXPECT_EQ(own.snapshot()->network.tasks.size(), 1U);
  EXPECT_FALSE(own.perform_all(std::vector{apply(task_of("b", "any::Thing"), "p")}, soon()).front());
}

TEST(LocalDeploymentDefaults, TasksRunAsTheirProcessSays) {
  const model::ComponentCatalog catalog;
  const task_host::LibrarySet libraries;
  task_host::LocalTaskHost host{
      libraries, catalog, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}}};
  auto info = info_of("p");
  info.deployment.cpus = {0};
  LocalDeployment deployment(info, host, nullptr);
  const auto outcomes = deployment.perform_all(std::vector{apply(task_of("a", "any::Thing"), "p")}, soon());
  ASSERT_TRUE(outcomes.front()) << to_string(outcomes.front().error());
  EXPECT_EQ(deployment.snapshot()->tasks.front().activity.cpus, std::vector{0});
}

TEST_F(LocalDeploymentTest, CarriesOutTheOthersWhereOneFails) {
  expect_done({apply(task_of("a", "any::Thing"), "p"), apply(task_of("b", "any::Thing"), "p")});
  const auto outcomes = perform({apply(task_of("c", "any::Thing"), "p"), on_task(ActionKind::Start, "a"),
                                 on_task(ActionKind::Configure, "b")});
  ASSERT_EQ(outcomes.size(), 3U);
  EXPECT_TRUE(outcomes[0]);
  ASSERT_FALSE(outcomes[1]);
  EXPECT_EQ(outcomes[1].error().code, ErrorCode::InvalidState);
  EXPECT_TRUE(outcomes[2]);
  EXPECT_EQ(state_of("a"), TaskState::PreOperational);
  EXPECT_EQ(state_of("b"), TaskState::Stopped);
}

TEST_F(LocalDeploymentTest, RefusesWhatIsNotForIt) {
  expect_refused(on_process(ActionKind::Deploy, "q"), ErrorCode::InvalidArgument, "process server");
  expect_refused(on_process(ActionKind::Undeploy, "p"), ErrorCode::InvalidArgument, "process server");
  expect_refused(apply(task_of("a", "any::Thing"), "q"), ErrorCode::InvalidArgument, "'localhost/q'");
  expect_refused(apply(task_of("a", "any::Thing")), ErrorCode::InvalidArgument, "'localhost/p'");
  EXPECT_THAT(deployment_.snapshot()->network.tasks, IsEmpty());
}

TEST_F(LocalDeploymentTest, ConnectsTasksInside) {
  bring_to_running(task_of("a", "any::Thing"));
  bring_to_running(task_of("b", "any::Thing"));
  const auto connection = wire("a", "out", "b", "in");
  expect_done({on_connection(ActionKind::Connect, connection)});
  EXPECT_EQ(deployment_.snapshot()->network.connections, std::vector{connection});
  EXPECT_EQ(deployment_.snapshot()->connections.size(), 1U);
}

TEST_F(LocalDeploymentTest, SaysThatItSharesNoMemory) {
  bring_to_running(task_of("a", "any::Thing"));
  const auto connection = wire("a", "out", "b", "in");
  EXPECT_EQ(deployment_.memory(soon()).error().code, ErrorCode::Unsupported);
  EXPECT_EQ(deployment_.admit(sample_link::MemoryOffer(), soon()).error().code, ErrorCode::Unsupported);
  EXPECT_TRUE(deployment_.forget(3));
  const std::vector<model::PortRef> ports{connection.from};
  EXPECT_EQ(deployment_.describe_outputs(ports, soon()).at(0).error().code, ErrorCode::Unsupported);
  const std::vector<OpenInput> inputs{{connection, {}}};
  EXPECT_EQ(deployment_.open_inputs(inputs, soon()).at(0).error().code, ErrorCode::Unsupported);
  const std::vector<AttachOutput> outputs{{connection, {}}};
  EXPECT_EQ(deployment_.attach_outputs(outputs, soon()).at(0).error().code, ErrorCode::Unsupported);
  const std::vector<CloseEndpoint> endpoints{{connection, Side::Input, true, 1},
                                             {connection, Side::Output, false, 2}};
  for (const auto& closed : deployment_.close_endpoints(endpoints, soon())) {
    EXPECT_TRUE(closed) << "what is not there need not be closed";
  }
}

TEST_F(LocalDeploymentTest, TellsWhichTaskHangsInAHookWhileOthersGoOn) {
  expect_done({apply(stuck_in("s", "configure"), "p")});
  const std::vector actions{on_task(ActionKind::Configure, "s")};
  // Long enough for the hook to begin.
  const auto late = deployment_.perform_all(actions, in(std::chrono::seconds(1))).front();
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().code, ErrorCode::DeadlineExceeded);
  EXPECT_TRUE(hang_now({model::TaskId("s")}));
  bring_to_running(task_of("a", "any::Thing"));
  hooks::release("s");
  EXPECT_TRUE(hang_now({}));
  EXPECT_EQ(state_of("s"), TaskState::Stopped);
}

TEST_F(LocalDeploymentTest, TellsWhatHasEndedWhileAnotherHookIsAtWork) {
  expect_done({apply(stuck_in("s", "configure"), "p"), apply(task_of("a", "any::Thing"), "p"),
               apply(task_of("b", "any::Thing"), "p")});
  Mutex mutex;
  ConditionVariable changed;
  std::set<std::size_t> reported;
  const std::vector actions{on_task(ActionKind::Configure, "s"), on_task(ActionKind::Configure, "a"),
                            on_task(ActionKind::Start, "b")};
  deployment_.begin_all(actions, soon(), [&](const std::vector<task_host::Completed>& ended) {
    const Lock lock(mutex);
    for (const auto& one : ended) {
      EXPECT_EQ(one.outcome.has_value(), one.index != 2) << "b was not configured";
      reported.insert(one.index);
    }
    changed.notify_all();
  });
  Lock lock(mutex);
  ASSERT_TRUE(changed.wait_until(mutex, soon(), [&] { return reported.size() == 2; }));
  EXPECT_FALSE(reported.contains(0));
  hooks::release("s");
  ASSERT_TRUE(changed.wait_until(mutex, soon(), [&] { return reported.size() == 3; }));
}

TEST_F(LocalDeploymentTest, TellsWhichTaskHangsInItsUpdate) {
  bring_to_running(stuck_in("s", "update"));
  ASSERT_TRUE(hooks::wait_until_inside("s"));
  EXPECT_TRUE(hang_now({})) << "nobody wants anything of it yet";
  const std::vector actions{on_task(ActionKind::Stop, "s")};
  const auto stopped = deployment_.perform_all(actions, in(std::chrono::milliseconds(5)));
  ASSERT_FALSE(stopped.front());
  EXPECT_EQ(stopped.front().error().code, ErrorCode::DeadlineExceeded);
  EXPECT_TRUE(hang_now({model::TaskId("s")}));
  hooks::release("s");
  EXPECT_TRUE(hang_now({}));
  expect_done({on_task(ActionKind::Stop, "s")});
}

TEST_F(LocalDeploymentTest, ReportsATaskAsFatalWhoseUpdateExceedsItsDeadline) {
  bring_to_running(overdue_in("s", "update"));
  ASSERT_TRUE(hooks::wait_until_inside("s"));
  EXPECT_TRUE(hang_now({model::TaskId("s")}));
  EXPECT_EQ(state_of("s"), TaskState::Fatal);
  const auto report = deployment_.snapshot()->tasks.front();
  EXPECT_EQ(report.state, TaskState::Fatal);
  EXPECT_EQ(report.error, "on_update has not returned within 1ms");
  // A deadline that does not pass in this test: nothing waits for what is overdue.
  const auto stopped = perform({on_task(ActionKind::Stop, "s")});
  EXPECT_EQ(stopped.front().error().code, ErrorCode::DeadlineExceeded);
  hooks::release("s");
  EXPECT_TRUE(hang_now({}));
  EXPECT_EQ(state_of("s"), TaskState::Running);
}

TEST(LocalHostOfOverdueTasks, RemovesAProcessWhoseTaskHangsAndDestroysTheTaskWhenItReturns) {
  hooks::reset();
  const model::ComponentCatalog catalog;
  const task_host::LibrarySet libraries;
  task_host::LocalTaskHost host{libraries, catalog, {}};
  const auto done = [&](const model::Action& action) { return host.perform(action, soon()).has_value(); };
  ASSERT_TRUE(done(on_process(ActionKind::Deploy, "p")));
  ASSERT_TRUE(done(apply(overdue_in("s", "update"), "p")));
  ASSERT_TRUE(done(on_task(ActionKind::Configure, "s")));
  ASSERT_TRUE(done(on_task(ActionKind::Start, "s")));
  ASSERT_TRUE(hooks::wait_until_inside("s"));
  ASSERT_TRUE(eventually([&] { return host.hanging().contains(model::TaskId("s")); }));
  EXPECT_TRUE(done(on_process(ActionKind::Undeploy, "p")));
  EXPECT_TRUE(host.observe().empty());
  EXPECT_FALSE(host.at_rest());
  hooks::release("s");
  EXPECT_TRUE(eventually([&] { return host.at_rest(); }));
}

TEST_F(LocalDeploymentTest, TellsOfATaskThatFailsByItself) {
  Mutex mutex;
  ConditionVariable reported;
  std::vector<task_host::TaskEvent> events;
  deployment_.set_listener([&](const task_host::TaskEvent& event) {
    const Lock lock(mutex);
    events.push_back(event);
    reported.notify_all();
  });
  const type::Value behaviour = type::Value::map({{"fail", "update"}, {"rate", 1000}});
  bring_to_running(task_of("a", "any::Thing", type::Value::map({{"stand_in", behaviour}})));
  Lock lock(mutex);
  ASSERT_TRUE(reported.wait_for(mutex, std::chrono::seconds(60), [&] { return !events.empty(); }));
  EXPECT_EQ(events.front().task, model::TaskId("a"));
  lock.unlock();
  deployment_.set_listener({});
}

TEST_F(LocalDeploymentTest, GoesDownInOrder) {
  bring_to_running(stuck_in("c", ""));
  bring_to_running(stuck_in("b", ""));
  bring_to_running(stuck_in("a", ""));
  expect_done({on_connection(ActionKind::Connect, wire("a", "out", "b", "in")),
               on_connection(ActionKind::Connect, wire("b", "out", "c", "in"))});
  hooks::forget_log();
  EXPECT_TRUE(deployment_.shut_down(soon()));
  EXPECT_THAT(hooks::log(), ElementsAre("stop a", "stop b", "stop c", "cleanup a", "cleanup b", "cleanup c"));
  for (const char* id : {"a", "b", "c"}) {
    EXPECT_EQ(state_of(id), TaskState::PreOperational);
  }
  expect_refused(on_task(ActionKind::Configure, "a"), ErrorCode::Unavailable, "going down");
  EXPECT_FALSE(deployment_.call(model::TaskId("a"), "x", {}, soon()));
  EXPECT_TRUE(deployment_.shut_down(soon())) << "again is free";
}

TEST(LocalDeploymentGoing, GivesUpWhatHangsAndStopsTheRest) {
  hooks::reset();
  // Nothing is destroyed that the hanging thread needs, like in a process that ends by std::_Exit.
  static const model::ComponentCatalog& catalog = *new model::ComponentCatalog;
  static const task_host::LibrarySet& libraries = *new task_host::LibrarySet;
  static auto& kept = *new std::vector<task_host::LocalTaskHost*>;
  task_host::LocalTaskHost& host = *kept.emplace_back(new task_host::LocalTaskHost(libraries, catalog));
  LocalDeployment deployment(info_of("p"), host, nullptr);
  for (const auto& task : {stuck_in("s", "stop"), stuck_in("a", "")}) {
    for (const auto& action : {apply(task, "p"), on_task(ActionKind::Configure, task.id.str()),
                               on_task(ActionKind::Start, task.id.str())}) {
      const auto done = deployment.perform_all(std::vector{action}, soon()).front();
      ASSERT_TRUE(done) << to_string(done.error());
    }
  }
  EXPECT_FALSE(deployment.shut_down(in(std::chrono::seconds(2))));
  EXPECT_EQ(host.observe().find_task(model::TaskId("a"))->state, TaskState::PreOperational);
  EXPECT_EQ(host.observe().find_task(model::TaskId("s"))->state, TaskState::Fatal) << "it hangs";
  hooks::release_all();
}

TEST_F(LocalDeploymentTest, WaitsForActionsUnderWayWhenItGoesDown) {
  expect_done({apply(stuck_in("s", "configure"), "p")});
  std::thread caller([&] { expect_done({on_task(ActionKind::Configure, "s")}); });
  ASSERT_TRUE(hooks::wait_until_inside("s"));
  std::thread going([&] { EXPECT_TRUE(deployment_.shut_down(soon())); });
  TimePoint limit = soon();
  while (deployment_.perform_all(std::vector{on_task(ActionKind::Stop, "x")}, soon()).front().error().code !=
         ErrorCode::Unavailable) {
    ASSERT_LT(RealClock::instance().now(), limit);
  }
  hooks::release("s");
  caller.join();
  going.join();
  EXPECT_EQ(state_of("s"), TaskState::PreOperational);
}

}  // namespace
}  // namespace segue::deploy
