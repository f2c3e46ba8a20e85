// SPDX-License-Identifier: Apache-2.0
// The promises of task_host::TaskHost, checked on all that implement it.
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/deploy/local_deployment.hpp>
#include <segue/distributed/distributed_task_host.hpp>
#include <segue/fleet/deployed_task_host.hpp>
#include <segue/task_host/early_end.hpp>
#include <segue/task_host/test_support.hpp>

#include <gmock/gmock.h>

#include <array>
#include <future>
#include <map>
#include <memory>

namespace segue::distributed {
namespace {

using model::ActionKind;
using task_host::LocalTaskHost;
using task_host::testing::on_connection;
using task_host::testing::on_process;
using task_host::testing::on_task;
using task_host::testing::soon;
using task_host::testing::task_of;
using task_host::testing::wire;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

constexpr const char* kComponents = R"(
components:
  demo::Mux:
    ports:
      - {name: in, direction: input, type: /double}
      - {name: out, direction: output, type: /double}
    properties:
      - {name: gain, type: /double, default: 2.0}
      - {name: mode, type: /std/string, default: fast, live: true}
    operations:
      - {name: count, arguments: [{name: from, type: /int32_t}], result: /int32_t}
)";

/// Deployment processes that are objects of this process, each with a LocalTaskHost of its own.
class DeploymentsHere final : public process_server::ProcessService {
 public:
  explicit DeploymentsHere(const model::ComponentCatalog& catalog) : catalog_(catalog) {}
  Result<process_server::ProcessInfo> start(const process_server::Launch& launch,
                                            TimePoint /*deadline*/) override {
    const Lock lock(mutex_);
    process_server::ProcessInfo info;
    info.robot = launch.robot;
    info.key = launch.deployment.key();
    info.pid = static_cast<int>(running_.size()) + 1;
    info.socket = to_string(info.key);
    running_[info.socket] = {launch, info};
    return info;
  }
  Result<process_server::ExitReason> stop(const std::string& /*robot*/, const model::DeploymentKey& key,
                                          TimePoint /*deadline*/) override {
    const Lock lock(mutex_);
    running_.erase(to_string(key));
    return process_server::ExitReason{.requested = true};
  }
  Result<process_server::ExitReason> kill(const std::string& robot, const model::DeploymentKey& key,
                                          TimePoint deadline) override {
    return stop(robot, key, deadline);
  }
  Result<std::vector<process_server::ProcessInfo>> processes(const std::string& /*robot*/) override {
    const Lock lock(mutex_);
    std::vector<process_server::ProcessInfo> all;
    for (const auto& [socket, process] : running_)
      all.push_back(process.second);
    return all;
  }
  void set_listener(Listener /*listener*/) override {}

  Result<deploy::ConnectedDeployment> connect(const std::filesystem::path& socket) {
    const Lock lock(mutex_);
    const auto found = running_.find(socket);
    if (found == running_.end()) return fail(ErrorCode::Unavailable, "there is no such process");
    deploy::DeploymentInfo info;
    info.robot = found->second.first.robot;
    info.deployment = found->second.first.deployment;
    info.pid = found->second.second.pid;
    info.incarnation = static_cast<sample_link::Incarnation>(info.pid) + 1;
    hosts_.push_back(
        std::make_unique<LocalTaskHost>(libraries_, catalog_, task_host::LocalOptions{.stand_in = true}));
    return deploy::ConnectedDeployment{
        std::make_unique<deploy::LocalDeployment>(info, *hosts_.back(), nullptr), info};
  }

 private:
  const model::ComponentCatalog& catalog_;
  const task_host::LibrarySet libraries_;
  Mutex mutex_;
  std::map<std::string, std::pair<process_server::Launch, process_server::ProcessInfo>> running_
      SEGUE_GUARDED_BY(mutex_);
  std::vector<std::unique_ptr<LocalTaskHost>> hosts_ SEGUE_GUARDED_BY(mutex_);
};

process_server::Launch launch() {
  process_server::Launch launch;
  launch.robot = "conformance";
  launch.stand_in = true;
  return launch;
}

enum class Place { Local, OwnProcess, OtherProcess, Distributed };

class HostConformance : public ::testing::TestWithParam<Place> {
 protected:
  HostConformance() {
    Diagnostics diagnostics;
    EXPECT_TRUE(model::read_components(kComponents, "mux.yaml", catalog_, diagnostics));
    if (GetParam() == Place::OtherProcess) {
      process_ = "p";
      expect_done(on_process(ActionKind::Deploy, process_));
    }
  }
  ~HostConformance() override { host().set_listener({}); }

  task_host::TaskHost& host() {
    switch (GetParam()) {
      case Place::Local:
        return local_;
      case Place::Distributed:
        return distributed_;
      default:
        return deployed_;
    }
  }
  void expect_done(const model::Action& action) {
    const auto done = host().perform(action, soon());
    EXPECT_TRUE(done) << action.label() << ": " << to_string(done.error());
  }
  void make(std::string_view id, type::Value properties = type::ValueMap{}) {
    expect_done(task_host::testing::apply(task_of(id, "demo::Mux", std::move(properties)), process_));
  }
  void bring_to_running(std::string_view id, type::Value properties = type::ValueMap{}) {
    make(id, std::move(properties));
    expect_done(on_task(ActionKind::Configure, id));
    expect_done(on_task(ActionKind::Start, id));
  }
  std::optional<TaskState> state_of(std::string_view id) {
    const model::Network network = host().observe();
    const auto* task = network.find_task(model::TaskId(id));
    return task == nullptr ? std::nullopt : std::optional(task->state);
  }
  static type::Value stand_in(const type::Value& behaviour) {
    return type::Value::map({{"stand_in", behaviour}});
  }

  std::string process_;
  model::ComponentCatalog catalog_;
  const task_host::LibrarySet libraries_;
  LocalTaskHost local_{libraries_, catalog_, {.stand_in = true}};
  deploy::LocalDeployment own_{
      {.robot = "conformance", .deployment = {}, .pid = 0, .software = {}, .incarnation = 1},
      local_,
      nullptr};
  DeploymentsHere processes_{catalog_};
  fleet::DeployedTaskHost deployed_{
      own_, processes_,
      [this](const std::filesystem::path& socket, TimePoint, const std::function<void()>&) {
        return processes_.connect(socket);
      },
      launch(), local_};
  DistributedTaskHost distributed_{
      deployed_,
      {},
      catalog_,
      {.request = {.holder = "x/1/1", .launch = launch(), .models = {}}, .gateways = {}, .stand_in = true}};
};

TEST_P(HostConformance, WalksATaskThroughItsLifeCycle) {
  make("a");
  EXPECT_EQ(state_of("a"), TaskState::PreOperational);
  const std::vector<std::pair<ActionKind, TaskState>> steps = {
      {ActionKind::Configure, TaskState::Stopped},
      {ActionKind::Start, TaskState::Running},
      {ActionKind::Stop, TaskState::Stopped},
      {ActionKind::Cleanup, TaskState::PreOperational}};
  for (const auto& [kind, state] : steps) {
    expect_done(on_task(kind, "a"));
    EXPECT_EQ(state_of("a"), state);
  }
}

TEST_P(HostConformance, RefusesVerbsThatTheStateDoesNotAllow) {
  make("a");
  const auto refused = host().perform(on_task(ActionKind::Start, "a"), soon());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::InvalidState);
  EXPECT_EQ(state_of("a"), TaskState::PreOperational);
}

TEST_P(HostConformance, KnowsNoTaskThatIsNotThere) {
  bring_to_running("a");
  const model::TaskId none("none");
  EXPECT_EQ(host().perform(on_task(ActionKind::Stop, "none"), soon()).error().code, ErrorCode::NotFound);
  EXPECT_EQ(host().describe(none).error().code, ErrorCode::NotFound);
  EXPECT_EQ(host().properties(none).error().code, ErrorCode::NotFound);
  EXPECT_EQ(host().details(none).error().code, ErrorCode::NotFound);
  EXPECT_EQ(host().set_property(none, "mode", "slow", soon()).error().code, ErrorCode::NotFound);
  EXPECT_EQ(host().call(none, "count", type::ValueMap{}, soon()).error().code, ErrorCode::NotFound);
  EXPECT_EQ(host().write({none, "in"}, 1.0, soon()).error().code, ErrorCode::NotFound);
}

TEST_P(HostConformance, ReportsEachActionOfABatchOnce) {
  for (const char* id : {"a", "b", "c"})
    make(id);
  const std::vector<model::Action> actions = {on_task(ActionKind::Configure, "a"),
                                              on_task(ActionKind::Start, "b"),
                                              on_task(ActionKind::Configure, "c")};
  Mutex mutex;
  ConditionVariable changed;
  std::vector<std::pair<std::size_t, bool>> reported;
  host().begin_all(actions, soon(), [&](const std::vector<task_host::Completed>& completed) {
    const Lock lock(mutex);
    for (const auto& one : completed)
      reported.emplace_back(one.index, one.outcome.has_value());
    changed.notify_all();
  });
  const Lock lock(mutex);
  ASSERT_TRUE(changed.wait_until(mutex, soon(), [&] { return reported.size() == actions.size(); }));
  EXPECT_THAT(reported, UnorderedElementsAre(std::pair(0U, true), std::pair(1U, false), std::pair(2U, true)))
      << "a failure keeps no other from being carried out";
}

TEST_P(HostConformance, CarriesOutActionsInTheirOrder) {
  make("a");
  std::vector<model::Action> actions = {on_task(ActionKind::Start, "a"), on_task(ActionKind::Configure, "a")};
  actions[1].id = 2;
  actions[0].after = {2};
  std::vector<std::size_t> order;
  Mutex mutex;
  host().perform_in_order(actions, std::chrono::seconds(30), {},
                          [&](const std::vector<task_host::Completed>& completed) {
                            const Lock lock(mutex);
                            for (const auto& one : completed) {
                              EXPECT_TRUE(one.outcome) << to_string(one.outcome.error());
                              order.push_back(one.index);
                            }
                          });
  EXPECT_THAT(order, ElementsAre(1, 0));
  EXPECT_EQ(state_of("a"), TaskState::Running);
}

TEST_P(HostConformance, BeginsNothingNewAfterAFailure) {
  make("a", stand_in(type::Value::map({{"fail", "configure"}})));
  std::vector<model::Action> actions = {on_task(ActionKind::Configure, "a"), on_task(ActionKind::Start, "a")};
  actions[1].id = 2;
  actions[1].after = {1};
  std::map<std::size_t, bool> begun;
  Mutex mutex;
  host().perform_in_order(actions, std::chrono::seconds(30), {},
                          [&](const std::vector<task_host::Completed>& completed) {
                            const Lock lock(mutex);
                            for (const auto& one : completed) {
                              EXPECT_FALSE(one.outcome);
                              begun[one.index] = one.begun;
                            }
                          });
  EXPECT_EQ(begun, (std::map<std::size_t, bool>{{0, true}, {1, false}}));
}

TEST_P(HostConformance, ReportsAnActionAtItsDeadlineThatHasNotEnded) {
  make("a", stand_in(type::Value::map({{"configure", "2s"}})));
  const std::vector<model::Action> actions = {on_task(ActionKind::Configure, "a")};
  const auto late = host().perform_all(actions, RealClock::instance().now() + std::chrono::milliseconds(50));
  ASSERT_EQ(late.size(), 1U);
  ASSERT_FALSE(late.front());
  EXPECT_EQ(late.front().error().code, ErrorCode::DeadlineExceeded) << to_string(late.front().error());
}

TEST_P(HostConformance, ShowsWhatRuns) {
  bring_to_running("a");
  make("b");
  expect_done(on_task(ActionKind::Configure, "b"));
  expect_done(on_connection(ActionKind::Connect, wire("a", "out", "b", "in")));
  const auto seen = host().snapshot();
  EXPECT_EQ(seen.network.tasks.size(), 2U);
  EXPECT_EQ(seen.tasks.size(), 2U);
  EXPECT_EQ(seen.connections.size(), 1U);
  EXPECT_THAT(seen.network.connections, ElementsAre(wire("a", "out", "b", "in")));
  EXPECT_EQ(host().connections().size(), 1U);
  expect_done(on_connection(ActionKind::Disconnect, wire("a", "out", "b", "in")));
  EXPECT_TRUE(host().connections().empty());
}

TEST_P(HostConformance, SetsPropertiesThatMayChange) {
  bring_to_running("a");
  const model::TaskId task("a");
  ASSERT_TRUE(host().set_property(task, "mode", "slow", soon()));
  EXPECT_EQ(*host().properties(task)->find("mode"), type::Value("slow"));
  const auto wrong = host().set_property(task, "gain", "far", soon());
  ASSERT_FALSE(wrong);
  EXPECT_THAT(to_string(wrong.error()), HasSubstr("gain"));
  EXPECT_FALSE(host().set_property(task, "nothing", 1, soon()));
}

TEST_P(HostConformance, CallsOperations) {
  bring_to_running("a");
  const auto answer = host().call(model::TaskId("a"), "count", type::Value::map({{"from", 1}}), soon());
  ASSERT_TRUE(answer) << to_string(answer.error());
  EXPECT_TRUE(answer->is_integer());
  EXPECT_EQ(host().call(model::TaskId("a"), "cuont", type::ValueMap{}, soon()).error().code,
            ErrorCode::NotFound);
}

TEST_P(HostConformance, DescribesTheInterfaceOfATask) {
  bring_to_running("a");
  const auto model = host().describe(model::TaskId("a"));
  ASSERT_TRUE(model) << to_string(model.error());
  EXPECT_NE(model->find_port("out", model::Direction::Output), nullptr);
  ASSERT_TRUE(host().details(model::TaskId("a")));
}

TEST_P(HostConformance, AnswersAWatchOnceTheTaskHasChanged) {
  make("a");
  task_host::LevelQuestion question{model::TaskId("a")};
  const auto ask = [&] {
    auto answer = std::make_shared<std::promise<Result<task_host::TaskLevel>>>();
    auto future = answer->get_future();
    host().watch(question, {soon(), {}},
                 [answer](Result<task_host::TaskLevel> level) { answer->set_value(std::move(level)); });
    return future;
  };
  const auto now = ask().get();
  ASSERT_TRUE(now) << to_string(now.error());
  EXPECT_EQ(now->state, TaskState::PreOperational) << "nothing is known: the answer comes at once";
  question.seen = *now;
  auto next = ask();
  expect_done(on_task(ActionKind::Configure, "a"));
  const auto changed = next.get();
  ASSERT_TRUE(changed) << to_string(changed.error());
  EXPECT_NE(changed->state, TaskState::PreOperational);
  question.task = model::TaskId("none");
  EXPECT_EQ(ask().get().error().code, ErrorCode::NotFound);
}

TEST_P(HostConformance, WritesOnlyToPortsOfTasksThatRun) {
  make("a");
  expect_done(on_task(ActionKind::Configure, "a"));
  EXPECT_EQ(host().write({model::TaskId("a"), "in"}, 1.0, soon()).error().code, ErrorCode::InvalidState);
  expect_done(on_task(ActionKind::Start, "a"));
  EXPECT_EQ(host().write({model::TaskId("a"), "nowhere"}, 1.0, soon()).error().code, ErrorCode::NotFound);
}

TEST_P(HostConformance, TellsThatATaskHasFailed) {
  Mutex mutex;
  ConditionVariable told;
  std::vector<task_host::TaskEvent> events;
  host().set_listener([&](const task_host::HostEvent& happened) {
    const auto* event = std::get_if<task_host::TaskEvent>(&happened);
    if (event == nullptr) return;
    const Lock lock(mutex);
    events.push_back(*event);
    told.notify_all();
  });
  bring_to_running("a", stand_in(type::Value::map({{"fail", "update"}, {"rate", 1000}})));
  {
    const Lock lock(mutex);
    ASSERT_TRUE(told.wait_until(mutex, soon(), [&] { return !events.empty(); }));
    EXPECT_EQ(events.front().task, model::TaskId("a"));
    EXPECT_EQ(events.front().state, TaskState::Exception);
  }
  host().set_listener({});
  EXPECT_EQ(state_of("a"), TaskState::Exception);
}

std::string name_of(const ::testing::TestParamInfo<Place>& place) {
  constexpr std::array kNames = {"Local", "OwnProcess", "OtherProcess", "Distributed"};
  return kNames.at(static_cast<std::size_t>(place.param));
}

INSTANTIATE_TEST_SUITE_P(Hosts, HostConformance,
                         ::testing::Values(Place::Local, Place::OwnProcess, Place::OtherProcess,
                                           Place::Distributed),
                         name_of);

}  // namespace
}  // namespace segue::distributed
