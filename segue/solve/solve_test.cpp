// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/solve.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <support/random_transitions.hpp>

namespace segue::solve {
namespace {

using model::ActionKind;
using model::Network;
using model::Task;
using model::TaskId;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

Task task(const char* id, TaskState state = TaskState::Running, const char* component = "demo::C") {
  Task created;
  created.id = TaskId(id);
  created.component = model::ComponentName(component);
  created.state = state;
  return created;
}

model::Connection connection(const char* from, const char* to) {
  return {{TaskId(from), "out"}, {TaskId(to), "in"}, {}, {}};
}

model::Deployment process(const char* name, std::vector<const char*> tasks) {
  model::Deployment created;
  created.process = model::ProcessName(name);
  for (const char* id : tasks)
    created.tasks.push_back({TaskId(id), id});
  return created;
}

std::vector<std::string> labels(const model::Transition& transition) {
  std::vector<std::string> found;
  for (const auto& action : transition.actions)
    found.push_back(action.label());
  return found;
}

Error error_of(const Network& current, const Network& target, const model::ComponentCatalog& catalog = {}) {
  const auto found = diff(current, target, catalog);
  EXPECT_FALSE(found) << "there should be no transition";
  return found ? Error{} : found.error();
}

TEST(Diff, FindsNothingBetweenEqualNetworks) {
  Network network;
  network.tasks = {task("a"), task("b", TaskState::Stopped)};
  network.connections = {connection("a", "b")};
  const auto found = diff(network, network, {});
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->actions.empty());
}

TEST(Diff, NamesBothNetworks) {
  Network a;
  a.name = model::NetworkName("a");
  Network b;
  b.name = model::NetworkName("b");
  const auto found = diff(a, b, {}, {model::Order::Paper});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->from, a.name);
  EXPECT_EQ(found->to, b.name);
  EXPECT_EQ(found->order, model::Order::Paper);
}

TEST(Diff, OrdersACycleAsDeclared) {
  Network target;
  target.tasks = {task("c"), task("a"), task("b")};
  target.connections = {connection("a", "b"), connection("b", "c"), connection("c", "a")};
  const auto found = diff(Network{}, target, {}, {model::Order::Paper});
  ASSERT_TRUE(found);
  const auto all = labels(*found);
  EXPECT_THAT(std::vector<std::string>(all.end() - 3, all.end()),
              ElementsAre("start c", "start a", "start b"));
}

TEST(Diff, CopesWithAVeryLongChain) {
  Network target;
  for (int i = 0; i < 50000; ++i)
    target.tasks.push_back(task(("t" + std::to_string(i)).c_str()));
  for (std::size_t i = 1; i < target.tasks.size(); ++i) {
    target.connections.push_back({{target.tasks[i - 1].id, "out"}, {target.tasks[i].id, "in"}, {}, {}});
  }
  const auto found = diff(Network{}, target, {}, {model::Order::Paper});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->actions.back().label(), "start t0");
}

TEST(Diff, DropsAFatalTaskInTheRuntimesOwnProcessButCannotReplaceIt) {
  Network current;
  current.tasks = {task("a", TaskState::Fatal)};
  Network target;
  target.tasks = {task("a")};
  const Error error = error_of(current, target);
  EXPECT_EQ(error.code, ErrorCode::Unsupported);
  EXPECT_EQ(error.subject, "a");
  target.tasks = {task("b")};
  const auto dropped = diff(current, target, {});
  ASSERT_TRUE(dropped);
  EXPECT_EQ(dropped->removes, std::vector{TaskId("a")});
  current.tasks[0].exclusive = {"/dev/x"};
  ASSERT_TRUE(diff(current, target, {}));
  target.tasks[0].exclusive = {"/dev/x"};
  EXPECT_EQ(error_of(current, target).subject, "a") << "it may hold the device for ever";
}

TEST(Diff, RefusesAnErrorAsTarget) {
  Network target;
  target.tasks = {task("a", TaskState::Exception)};
  const Error error = error_of({}, target);
  EXPECT_EQ(error.code, ErrorCode::InvalidArgument);
  EXPECT_THAT(error.message, HasSubstr("exception"));
}

TEST(Diff, RefusesADuplicateTask) {
  Network target;
  target.tasks = {task("a"), task("a")};
  EXPECT_THAT(error_of({}, target).message, HasSubstr("two tasks 'a'"));
}

TEST(Diff, RefusesATaskInTwoDeployments) {
  Network target;
  target.tasks = {task("a")};
  target.deployments = {process("p", {"a"}), process("q", {"a"})};
  EXPECT_THAT(error_of({}, target).message, HasSubstr("two deployments"));
}

TEST(Diff, RefusesADuplicateProcess) {
  Network target;
  target.deployments = {process("p", {}), process("p", {})};
  EXPECT_THAT(error_of({}, target).message, HasSubstr("deployed twice"));
}

TEST(Diff, RefusesAProcessWithoutName) {
  Network target;
  target.deployments = {process("", {})};
  EXPECT_THAT(error_of({}, target).message, HasSubstr("no process name"));
}

TEST(Diff, RefusesAConnectionToNowhere) {
  Network target;
  target.tasks = {task("a")};
  target.connections = {connection("a", "nowhere")};
  const Error error = error_of({}, target);
  EXPECT_EQ(error.subject, "nowhere");
  EXPECT_EQ(error.code, ErrorCode::InvalidArgument);
}

TEST(Diff, RefusesTwoConnectionsBetweenTheSamePorts) {
  Network target;
  target.tasks = {task("a"), task("b")};
  target.connections = {connection("a", "b"), connection("a", "b")};
  target.connections.back().policy.kind = BufferKind::Buffer;
  EXPECT_THAT(error_of({}, target).message, HasSubstr("same ports"));
  Network current = target;
  current.connections.pop_back();
  EXPECT_THAT(error_of(current, target).message, HasSubstr("same ports"));
}

TEST(Diff, RefusesTwoTasksOnOnePlacement) {
  Network target;
  target.tasks = {task("a"), task("b")};
  target.deployments = {process("p", {"a", "b"})};
  target.deployments[0].tasks[1].name = "a";
  EXPECT_THAT(error_of({}, target).message, HasSubstr("same name 'a'"));
}

TEST(Diff, RefusesAConnectionAtAPortThatWillNotExist) {
  const auto catalog = segue::testing::PairGenerator::catalog();
  Network target;
  target.tasks = {task("a"), task("b", TaskState::PreOperational, "demo::C1")};
  target.connections = {connection("a", "b")};
  EXPECT_TRUE(diff({}, target, catalog));
  target.connections[0].to.port = "dyn_x";
  EXPECT_THAT(error_of({}, target, catalog).message, HasSubstr("exists only while"));
}

// One transition per rule that predict() must refuse, wrong in one place.

class PredictTest : public ::testing::Test {
 protected:
  PredictTest() {
    current_.tasks = {task("a"), task("b", TaskState::Stopped), task("c", TaskState::PreOperational)};
    current_.deployments = {process("p", {"b"})};
    current_.connections = {connection("a", "b")};
  }

  void add(ActionKind kind, const char* id) { add(kind, model::TaskAction{TaskId(id)}); }
  template <class What>
  void add(ActionKind kind, What what) {
    model::Action action;
    action.id = static_cast<int>(transition_.actions.size()) + 1;
    action.kind = kind;
    action.what = std::move(what);
    transition_.actions.push_back(std::move(action));
  }

  std::string refusal() {
    const auto found = predict(current_, transition_, catalog_);
    if (found) return "";
    EXPECT_EQ(found.error().code, ErrorCode::InvalidState);
    return found.error().message;
  }

  model::ComponentCatalog catalog_ = segue::testing::PairGenerator::catalog();
  Network current_;
  model::Transition transition_;
};

TEST_F(PredictTest, NamesTheActionThatIsNotPossible) {
  add(ActionKind::Stop, "a");
  add(ActionKind::Stop, "a");
  const auto found = predict(current_, transition_, catalog_);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().subject, "2");
  EXPECT_THAT(found.error().message,
              HasSubstr("action 2 (stop a) is not possible: task 'a' is in state stopped"));
}

TEST_F(PredictTest, RefusesWhatTheLifeCycleForbids) {
  for (const auto& [kind, id] : std::vector<std::pair<ActionKind, const char*>>{{ActionKind::Recover, "a"},
                                                                                {ActionKind::Start, "a"},
                                                                                {ActionKind::Cleanup, "a"},
                                                                                {ActionKind::Configure, "a"},
                                                                                {ActionKind::Stop, "b"},
                                                                                {ActionKind::Configure, "b"},
                                                                                {ActionKind::Start, "c"},
                                                                                {ActionKind::Cleanup, "c"}}) {
    transition_.actions.clear();
    add(kind, id);
    EXPECT_THAT(refusal(), HasSubstr("which does not allow")) << to_string(kind) << " " << id;
  }
}

TEST_F(PredictTest, RefusesTasksThatDoNotExist) {
  add(ActionKind::CallOperation, model::CallAction{TaskId("x"), "op", {}});
  EXPECT_THAT(refusal(), HasSubstr("no task 'x'"));
}

TEST_F(PredictTest, RefusesToConnectTwiceAndToDisconnectNothing) {
  add(ActionKind::Connect, model::ConnectionAction{connection("a", "b")});
  EXPECT_THAT(refusal(), HasSubstr("connected already"));
  transition_.actions.clear();
  add(ActionKind::Disconnect, model::ConnectionAction{connection("b", "a")});
  EXPECT_THAT(refusal(), HasSubstr("no connection"));
}

TEST_F(PredictTest, RefusesToUndeployARunningTask) {
  add(ActionKind::Undeploy, model::DeploymentAction{process("p", {})});
  EXPECT_THAT(refusal(), HasSubstr("clean it up before its process is undeployed"));
}

TEST_F(PredictTest, RemovesTasksAndConnectionsOfAnUndeployedProcess) {
  add(ActionKind::Cleanup, "b");
  add(ActionKind::Undeploy, model::DeploymentAction{process("p", {})});
  const auto found = predict(current_, transition_, catalog_);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->tasks.size(), 2U);
  EXPECT_TRUE(found->connections.empty());
  EXPECT_TRUE(found->deployments.empty());
}

TEST_F(PredictTest, RefusesProcessesThatRunOrDoNotRun) {
  add(ActionKind::Deploy, model::DeploymentAction{process("p", {})});
  EXPECT_THAT(refusal(), HasSubstr("runs already"));
  transition_.actions.clear();
  add(ActionKind::Undeploy, model::DeploymentAction{process("q", {})});
  EXPECT_THAT(refusal(), HasSubstr("does not run"));
  transition_.actions.clear();
  add(ActionKind::ApplyConfig, model::ConfigAction{task("n"), process("q", {}).key(), "n"});
  EXPECT_THAT(refusal(), HasSubstr("does not run"));
}

TEST_F(PredictTest, RefusesANewConfigurationOfARunningTask) {
  Task changed = task("a");
  changed.config_names = {"other"};
  add(ActionKind::ApplyConfig, model::ConfigAction{changed, {}, "a"});
  EXPECT_THAT(refusal(), HasSubstr("only live properties"));
}

TEST_F(PredictTest, RefusesAHeldDevice) {
  current_.tasks[0].exclusive = {"/dev/a"};
  current_.tasks[2].exclusive = {"/dev/a"};
  add(ActionKind::Configure, "c");
  EXPECT_THAT(refusal(), HasSubstr("still held by task 'a'"));
}

TEST_F(PredictTest, RemovesConnectionsOfDynamicPorts) {
  current_.tasks[1].component = model::ComponentName("demo::C1");
  current_.connections[0].to.port = "dyn_x";
  add(ActionKind::Cleanup, "b");
  const auto found = predict(current_, transition_, catalog_);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->connections.empty());
  add(ActionKind::Connect, model::ConnectionAction{current_.connections[0]});
  EXPECT_THAT(refusal(), HasSubstr("exists only when"));
}

TEST_F(PredictTest, RefusesToRemoveARunningTask) {
  transition_.removes = {TaskId("b")};
  EXPECT_THAT(refusal(), HasSubstr("is to be removed, but is in state stopped and connected"));
}

TEST_F(PredictTest, RefusesToLeaveAnOldIncarnationRunning) {
  add(ActionKind::ApplyConfig, model::ConfigAction{task("b"), {}, "b"});
  EXPECT_THAT(refusal(), HasSubstr("old incarnation of task 'b' is left in state stopped"));
}

TEST_F(PredictTest, RefusesToWaitForLaterActions) {
  add(ActionKind::Stop, "a");
  transition_.actions[0].after = {2};
  EXPECT_THAT(refusal(), HasSubstr("waits for action 2"));
}

TEST_F(PredictTest, RefusesADuplicateId) {
  add(ActionKind::Stop, "a");
  add(ActionKind::Start, "a");
  transition_.actions[1].id = 1;
  EXPECT_THAT(refusal(), HasSubstr("same id"));
}

TEST_F(PredictTest, RefusesAnActionWithoutSubject) {
  add(ActionKind::Connect, "a");
  const auto found = predict(current_, transition_, catalog_);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::InvalidArgument);
}

}  // namespace
}  // namespace segue::solve
