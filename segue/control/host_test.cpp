// SPDX-License-Identifier: Apache-2.0
#include <segue/rpc_codecs/host.capnp.h>
#include <segue/base/mutex.hpp>
#include <segue/control/host_client.hpp>
#include <segue/control/server.hpp>
#include <support/fake_hosted_robot.hpp>
#include <support/hostile_client.hpp>
#include <support/random_actions.hpp>

#include <rapidcheck.h>

#include <atomic>
#include <future>
#include <map>
#include <semaphore>
#include <thread>

namespace segue::control {
namespace {

using namespace std::chrono_literals;
using model::TaskId;

class FakeHostDaemon final : public distributed::HostService {
 public:
  const std::shared_ptr<FakeHostedRobot> robot = std::make_shared<FakeHostedRobot>();
  distributed::HostInfo who{};
  std::vector<distributed::LeaseInfo> leases{};
  std::chrono::system_clock::time_point time{};

  distributed::RobotRequest request() {
    const Lock lock(mutex_);
    return request_;
  }
  Result<distributed::HostInfo> info() override { return who; }
  Result<std::chrono::system_clock::time_point> clock() override { return time; }
  Result<std::vector<distributed::LeaseInfo>> robots() override { return leases; }
  Result<std::uint64_t> highest_term(const std::string& name) override {
    return name == "spot" ? Result<std::uint64_t>(UINT64_MAX) : fail(ErrorCode::NotFound, "no such robot");
  }
  Result<process_server::LogPart> log(const distributed::LogRequest& request) override {
    if (request.process.str() == "none") return fail(ErrorCode::NotFound, "no output");
    process_server::LogPart part{request.robot + '\0' + std::to_string(request.lines), {7, request.lines}};
    if (request.after) part.end = *request.after;
    return part;
  }
  Result<std::shared_ptr<distributed::HostedRobot>> acquire(const distributed::RobotRequest& request,
                                                            TimePoint /*deadline*/) override {
    const Lock lock(mutex_);
    request_ = request;
    if (request.holder == "late") return fail(ErrorCode::AlreadyExists, "runtime 'early' commands it");
    return std::shared_ptr<distributed::HostedRobot>(robot);
  }

 private:
  Mutex mutex_;
  distributed::RobotRequest request_;
};

class HostTest : public ControlTest {
 protected:
  void TearDown() override {
    daemon_.robot->go_on.open();
    daemon_.robot->tasks.release.open();
    ControlTest::TearDown();
  }
  void serve() {
    auto server = Server::listen(socket_, &daemon_);
    ASSERT_TRUE(server) << to_string(server.error());
    server_ = std::move(*server);
  }
  std::unique_ptr<distributed::HostService> client(std::function<void()> gone = nullptr) {
    auto connected = connect_host(socket_, soon(), std::move(gone));
    EXPECT_TRUE(connected) << to_string(connected.error());
    return connected ? std::move(*connected) : nullptr;
  }
  static distributed::RobotRequest request() {
    distributed::RobotRequest request;
    request.holder = "me/1/2";
    request.launch.robot = "spot";
    return request;
  }
  static std::shared_ptr<distributed::HostedRobot> robot_of(distributed::HostService& host) {
    auto robot = host.acquire(request(), soon());
    EXPECT_TRUE(robot) << to_string(robot.error());
    return robot ? std::move(*robot) : nullptr;
  }

  FakeHostDaemon daemon_;
};

TEST_F(HostTest, WhatADaemonSaysTravels) {
  daemon_.who.name = model::HostName("left");
  daemon_.who.software = "9.9";
  daemon_.who.architecture = "aarch64";
  daemon_.who.pid = 42;
  daemon_.who.libraries = {{"lib", "0123", {model::ComponentName("a::B"), model::ComponentName("a::C")}},
                           {"none", "", {}}};
  daemon_.leases = {{"spot", "me/1/2", UINT64_MAX, 5s}, {"mule", "", 0, 0s}};
  daemon_.time = std::chrono::system_clock::now();
  serve();
  const auto host = client();
  const auto info = host->info().value();
  EXPECT_EQ(info.name, daemon_.who.name);
  EXPECT_EQ(info.software, "9.9");
  EXPECT_EQ(info.architecture, "aarch64");
  EXPECT_EQ(info.pid, 42);
  EXPECT_EQ(info.libraries, daemon_.who.libraries);
  EXPECT_EQ(host->clock().value(), daemon_.time);
  const auto leases = host->robots().value();
  ASSERT_EQ(leases.size(), 2U);
  EXPECT_EQ(leases[0].robot, "spot");
  EXPECT_EQ(leases[0].holder, "me/1/2");
  EXPECT_EQ(leases[0].epoch, UINT64_MAX);
  EXPECT_EQ(leases[0].left, Duration(5s));
  EXPECT_EQ(leases[1].robot, "mule");
  EXPECT_EQ(host->highest_term("spot").value(), UINT64_MAX);
  EXPECT_EQ(host->highest_term("mule").error().code, ErrorCode::NotFound);
}

TEST_F(HostTest, ARequestForARobotTravels) {
  serve();
  const auto host = client();
  auto asked = request();
  asked.launch.libraries = {"one", "two"};
  asked.launch.stand_in = true;
  asked.launch.stand_ins = "text";
  asked.launch.log_level = "debug";
  asked.models = {{"arm.yaml", std::string("a\0b", 3)}, {"", ""}};
  asked.take_over = true;
  asked.again = true;
  asked.term = UINT64_MAX;
  ASSERT_TRUE(host->acquire(asked, soon()));
  const auto got = daemon_.request();
  EXPECT_TRUE(got.again);
  EXPECT_EQ(got.term, UINT64_MAX);
  EXPECT_EQ(got.holder, asked.holder);
  EXPECT_EQ(got.launch, asked.launch);
  EXPECT_TRUE(got.take_over);
  ASSERT_EQ(got.models.size(), 2U);
  EXPECT_EQ(got.models[0].name, "arm.yaml");
  EXPECT_EQ(got.models[0].text, asked.models[0].text);
  asked.holder = "late";
  const auto refused = host->acquire(asked, soon());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::AlreadyExists);
  asked.launch.robot = "";
  EXPECT_FALSE(host->acquire(asked, soon()));
}

TEST_F(HostTest, OutputOfProcessesTravels) {
  serve();
  const auto host = client();
  const auto tail = host->log({"spot", model::ProcessName("p"), 5, {}});
  ASSERT_TRUE(tail) << to_string(tail.error());
  EXPECT_EQ(tail->text, std::string("spot\0"
                                    "5",
                                    6));
  EXPECT_EQ(tail->end, (process_server::LogPosition{7, 5}));
  const process_server::LogPosition last{UINT64_MAX, UINT64_MAX};
  EXPECT_EQ(host->log({"spot", model::ProcessName("p"), 5, last})->end, last);
  EXPECT_EQ(host->log({"spot", model::ProcessName("none"), 5, {}}).error().code, ErrorCode::NotFound);
}

TEST_F(HostTest, TransitionsOfARobotTravel) {
  serve();
  const auto host = client();
  const auto robot = robot_of(*host);
  auto& fake = *daemon_.robot;
  rc::check("round trip", [&](std::uint64_t seed) {
    segue::testing::Random random(seed);
    const auto transition = segue::testing::random_transition(random);
    const auto before = segue::testing::random_network(random, segue::testing::everything());
    const auto target = segue::testing::random_network(random, segue::testing::everything());
    RC_ASSERT(robot->begin_transition(before, target).has_value());
    const std::vector<distributed::LinkWait> links{{TaskId("a"), 1}, {TaskId("b"), 2}};
    RC_ASSERT(robot->get_ready(before, links, soon()).has_value());
    RC_ASSERT(fake.fields().before == before);
    RC_ASSERT(fake.fields().target == before);
    RC_ASSERT(fake.fields().links == links);
    RC_ASSERT(fake.fields().duration > 1s && fake.fields().duration <= kLong);
    RC_ASSERT(robot->expect(target).has_value());
    RC_ASSERT(fake.fields().target == target);
    RC_ASSERT(robot->arm_commit(transition, seed, soon()).has_value());
    RC_ASSERT(fake.fields().transition == transition);
    RC_ASSERT(fake.fields().number == seed);
    RC_ASSERT(fake.fields().duration > 1s && fake.fields().duration <= kLong);
    RC_ASSERT(robot->conclude({}).has_value());
    RC_ASSERT(fake.fields().transition == model::Transition{});
    RC_ASSERT(robot->perform_all(transition.actions, soon()).size() == transition.actions.size());
    RC_ASSERT(transition.actions.empty() || fake.tasks.seen()->performed == transition.actions);
    fake.set([&](auto& fields) { fields.view.network = target; });
    RC_ASSERT(robot->snapshot().value().network == target);
  });
}

TEST_F(HostTest, ActionsInTheirOrderTravel) {
  serve();
  const auto host = client();
  const auto robot = robot_of(*host);
  auto& fake = *daemon_.robot;
  rc::check("round trip", [&](std::uint64_t seed) {
    segue::testing::Random random(seed);
    const auto actions = segue::testing::random_transition(random).actions;
    std::promise<std::vector<task_host::Completed>> promise;
    auto all = promise.get_future();
    std::vector<task_host::Completed> known;
    if (actions.empty()) return;
    robot->begin_in_order(actions, 5s, [&, count = actions.size()](std::vector<task_host::Completed> ended) {
      std::move(ended.begin(), ended.end(), std::back_inserter(known));
      if (known.size() == count) promise.set_value(known);
    });
    const auto ended = all.get();
    RC_ASSERT(fake.fields().actions == actions);
    RC_ASSERT(fake.fields().duration == 5s);
    for (const auto& one : ended) {
      RC_ASSERT(one.begun == (one.index % 2 == 0));
      RC_ASSERT(one.span == (task_host::Span{std::chrono::milliseconds(one.index),
                                             std::chrono::milliseconds(one.index + 1)}));
    }
  });
}

TEST_F(HostTest, WhatFollowsTheBeginOfATransitionComesAfterIt) {
  serve();
  const auto host = client();
  const auto robot = robot_of(*host);
  auto& fake = *daemon_.robot;
  fake.slow_begin = true;
  ASSERT_TRUE(robot->begin_transition({}, {})) << "which the host has not answered yet";
  robot->begin_in_order(
      {{1, model::ActionKind::Start, model::TaskAction{TaskId("a")}, model::Phase::Prepare, {}}}, 5s,
      [](const std::vector<task_host::Completed>&) {});
  robot->begin_no_more();
  fake.entered.wait();
  EXPECT_EQ(fake.fields().asked, std::vector<std::string>());
  fake.go_on.open();
  ASSERT_TRUE(robot->withdraw());
  EXPECT_EQ(fake.fields().asked,
            (std::vector<std::string>{"begin_transition", "begin_in_order", "begin_no_more", "withdraw"}));
}

TEST_F(HostTest, AClientMayBeGoneWhileItsTransitionBegins) {
  serve();
  auto& fake = *daemon_.robot;
  fake.slow_begin = true;
  {
    auto host = client();
    auto robot = robot_of(*host);
    ASSERT_TRUE(robot->begin_transition({}, {}));
    robot->begin_in_order(
        {{1, model::ActionKind::Start, model::TaskAction{TaskId("a")}, model::Phase::Prepare, {}}}, 5s,
        [](const std::vector<task_host::Completed>&) {});
    fake.entered.wait();
  }
  const auto host = client();
  ASSERT_TRUE(host->info()) << "so that the loop has noticed";
  fake.go_on.open();
  ASSERT_TRUE(eventually([&] {
    const auto asked = fake.fields().asked;
    return std::find(asked.begin(), asked.end(), "begin_transition") != asked.end();
  }));
  EXPECT_TRUE(robot_of(*host)->withdraw());
}

TEST_F(HostTest, WhoeverLosesTheConnectionBeginsNoMore) {
  serve();
  auto host = client();
  auto robot = robot_of(*host);
  ASSERT_TRUE(robot->withdraw());
  robot.reset();
  host.reset();
  const auto asked = [&] { return daemon_.robot->fields().asked; };
  ASSERT_TRUE(eventually([&] { return asked().size() == 2; }));
  EXPECT_EQ(asked().back(), "begin_no_more");
}

TEST_F(HostTest, OrdersOfACommitTravel) {
  serve();
  const auto host = client();
  const auto robot = robot_of(*host);
  auto& fake = *daemon_.robot;
  EXPECT_TRUE(robot->vote(UINT64_MAX, 1234567891ns));
  EXPECT_EQ(fake.fields().number, UINT64_MAX);
  EXPECT_EQ(fake.fields().duration, 1234567891ns);
  EXPECT_TRUE(robot->commit(7));
  EXPECT_EQ(fake.fields().number, 7U);
  EXPECT_TRUE(robot->withdraw());
  EXPECT_TRUE(robot->renew());
  EXPECT_TRUE(robot->release());
  EXPECT_TRUE(robot->end_processes(soon()));
  EXPECT_LE(fake.fields().duration, kLong);
  EXPECT_EQ(fake.fields().asked,
            (std::vector<std::string>{"vote", "commit", "withdraw", "renew", "release", "end_processes"}));
}

TEST_F(HostTest, RefusalsTravel) {
  serve();
  const auto host = client();
  const auto robot = robot_of(*host);
  daemon_.robot->set([](auto& fields) { fields.refusal = fail(ErrorCode::Superseded, "no", "spot"); });
  const std::map<std::string, Result<void>> answers = {{"renew", robot->renew()},
                                                       {"release", robot->release()},
                                                       {"expect", robot->expect({})},
                                                       {"get_ready", robot->get_ready({}, {}, soon())},
                                                       {"arm_commit", robot->arm_commit({}, 1, soon())},
                                                       {"vote", robot->vote(1, 1s)},
                                                       {"commit", robot->commit(1)},
                                                       {"conclude", robot->conclude({})},
                                                       {"withdraw", robot->withdraw()},
                                                       {"end_processes", robot->end_processes(soon())}};
  for (const auto& [what, answer] : answers) {
    ASSERT_FALSE(answer) << what;
    EXPECT_EQ(answer.error().code, ErrorCode::Superseded) << what;
    EXPECT_EQ(answer.error().subject, "spot") << what;
  }
  EXPECT_EQ(robot->snapshot().error().code, ErrorCode::Superseded);
}

TEST_F(HostTest, ArgumentsThatCannotBeDecodedAreRefusedAndTheRobotLives) {
  serve();
  Speaker speaker(socket_);
  ASSERT_EQ(speaker.hello(detail::kProtocolVersion, "host").message, "");
  const auto refuses = [&](auto new_request, auto fill) {
    const Error answer = speaker.ask([&](capnp::Capability::Client service) -> kj::Promise<Error> {
      auto acquire = service.castAs<wire::Host>().acquireRequest();
      acquire.setTimeout(Duration(kLong).count());
      process_server::Launch launch = request().launch;
      launch.deployment.process = model::ProcessName("any");
      detail::put(process_server::to_value(launch), acquire.initLaunch());
      auto call = new_request(acquire.send().getRobot());
      fill(call);
      return call.send().then([](auto&& response) { return detail::decode(response.getError()); });
    });
    EXPECT_EQ(answer.code, ErrorCode::ParseError) << to_string(answer);
  };
  const auto bad_action = [](auto& call) { call.initActions(1)[0].setKind(200); };
  const auto bad_order = [](auto& call) { call.initTransition().setOrder(200); };
  const auto bad_connection = [](auto& call) { call.initTarget().initConnections(1)[0].setKind(200); };
  refuses([](auto robot) { return robot.performRequest(); }, bad_action);
  refuses([](auto robot) { return robot.performInOrderRequest(); }, bad_action);
  refuses([](auto robot) { return robot.armCommitRequest(); }, bad_order);
  refuses([](auto robot) { return robot.concludeRequest(); }, bad_order);
  refuses([](auto robot) { return robot.getReadyRequest(); }, bad_connection);
  refuses([](auto robot) { return robot.beginTransitionRequest(); }, bad_connection);
  for (const std::string& asked : daemon_.robot->fields().asked)
    EXPECT_EQ(asked, "begin_no_more") << "where nobody holds the robot any more";
  const auto host = client();
  EXPECT_TRUE(robot_of(*host)->renew());
}

TEST_F(HostTest, TasksOfARobotAreAskedThroughItsHost) {
  serve();
  const auto host = client();
  const auto robot = robot_of(*host);
  ASSERT_TRUE(robot->set_property(TaskId("a"), "what", type::Value("properties"), soon()));
  EXPECT_EQ(robot->properties(TaskId("a")).value(), type::Value("properties"));
  EXPECT_EQ(robot->properties(TaskId("no")).error().code, ErrorCode::NotFound);
  const task::SavedState state{"/demo/State", 3, type::Value(5)};
  EXPECT_FALSE(robot->save_state(TaskId("a"), soon()).value());
  ASSERT_TRUE(robot->restore_state(TaskId("a"), state, soon()));
  EXPECT_EQ(robot->save_state(TaskId("a"), soon()).value(), state);
  ASSERT_TRUE(robot->write({TaskId("a"), "in"}, type::Value(7), soon()));
  EXPECT_EQ(daemon_.robot->tasks.seen()->wrote, type::Value::map({{"port", "a.in"}, {"value", 7}}));
  const auto reader = robot->open_reader({TaskId("a"), "out"}, 5);
  ASSERT_TRUE(reader) << to_string(reader.error());
  EXPECT_EQ((*reader)->read(2).size(), 2U);
}

TEST_F(HostTest, WhatAHostHoldsTravels) {
  serve();
  const auto host = client();
  const auto robot = robot_of(*host);
  daemon_.robot->set([](auto& fields) {
    task_host::TaskReport task;
    task.id = TaskId("a");
    task.process = {model::HostName("left"), model::ProcessName("p")};
    task.pid = 7;
    task.error = "bad";
    fields.view.tasks = {task};
    task_host::ConnectionReport connection;
    connection.connection.from = {TaskId("a"), "out"};
    connection.connection.to = {TaskId("b"), "in"};
    connection.written = UINT64_MAX;
    connection.dropped = 3;
    fields.view.connections = {connection};
  });
  const auto view = robot->snapshot().value();
  ASSERT_EQ(view.tasks.size(), 1U);
  EXPECT_EQ(view.tasks[0].id, TaskId("a"));
  EXPECT_EQ(to_string(view.tasks[0].process), "left/p");
  EXPECT_EQ(view.tasks[0].pid, 7);
  EXPECT_EQ(view.tasks[0].error, "bad");
  ASSERT_EQ(view.connections.size(), 1U);
  EXPECT_EQ(view.connections[0].written, UINT64_MAX);
  EXPECT_EQ(view.connections[0].dropped, 3U);
}

TEST_F(HostTest, EventsOfARobotTravel) {
  serve();
  const auto host = client();
  const auto robot = robot_of(*host);
  Mutex mutex;
  std::vector<task_host::HostEvent> events;
  robot->set_listener([&](const task_host::HostEvent& event) {
    const Lock lock(mutex);
    events.push_back(event);
  });
  ASSERT_TRUE(eventually([&] { return daemon_.robot->has_listener(); }));
  daemon_.robot->tell(task_host::TaskEvent{TaskId("a"), TaskState::Fatal, "why"});
  daemon_.robot->tell(
      task_host::ProcessEvent{{model::HostName("left"), model::ProcessName("p")}, "has ended", true});
  ASSERT_TRUE(eventually([&] {
    const Lock lock(mutex);
    return events.size() == 2;
  }));
  const Lock lock(mutex);
  const auto& task = std::get<task_host::TaskEvent>(events[0]);
  EXPECT_EQ(task.task, TaskId("a"));
  EXPECT_EQ(task.state, TaskState::Fatal);
  EXPECT_EQ(task.message, "why");
  const auto& process = std::get<task_host::ProcessEvent>(events[1]);
  EXPECT_EQ(to_string(process.process), "left/p");
  EXPECT_EQ(process.message, "has ended");
  EXPECT_TRUE(process.gone);
}

TEST_F(HostTest, AConnectionThatBreaksIsTold) {
  serve();
  std::atomic<int> gone{0};
  const auto host = client([&] { ++gone; });
  const auto robot = robot_of(*host);
  daemon_.robot->blocks = true;
  auto blocked = std::async(std::launch::async, [&] { return robot->withdraw(); });
  daemon_.robot->entered.wait();
  auto ends = std::async(std::launch::async, [&] { server_.reset(); });
  daemon_.robot->go_on.open();
  ends.get();
  EXPECT_TRUE(blocked.get()) << "calls in progress are answered";
  EXPECT_TRUE(eventually([&] { return gone == 1; }));
  EXPECT_EQ(robot->snapshot().error().code, ErrorCode::Unavailable);
  EXPECT_EQ(robot->renew().error().code, ErrorCode::Unavailable);
  EXPECT_EQ(robot->vote(1, 1s).error().code, ErrorCode::Unavailable);
  EXPECT_EQ(robot->commit(1).error().code, ErrorCode::Unavailable);
  EXPECT_EQ(robot->properties(TaskId("a")).error().code, ErrorCode::Unavailable);
  const auto actions = {action_of(model::ActionKind::Stop, "a")};
  EXPECT_EQ(robot->perform_all(actions, soon()).front().error().code, ErrorCode::Unavailable);
  EXPECT_EQ(host->info().error().code, ErrorCode::Unavailable);
  EXPECT_EQ(host->acquire(request(), soon()).error().code, ErrorCode::Unavailable);
  EXPECT_EQ(gone, 1);
}

TEST_F(HostTest, ARobotKeepsItsConnection) {
  serve();
  auto host = client();
  const auto robot = robot_of(*host);
  host.reset();
  EXPECT_TRUE(robot->snapshot());
  EXPECT_TRUE(robot->renew());
}

TEST_F(HostTest, ClientsAndServersMayEndAtAnyTime) {
  for (int round = 0; round < 15; ++round) {
    serve();
    std::atomic<bool> over{false};
    std::counting_semaphore<> answered{0};  // calls
    std::vector<std::thread> users;
    for (int i = 0; i < 2; ++i) {
      users.emplace_back([&] {
        std::atomic<int> heard{0};
        auto connected = connect_host(socket_, soon(), [&] { ++heard; });
        if (!connected) return;
        auto robot = (*connected)->acquire(request(), soon());
        if (!robot) return;
        (*robot)->set_listener([&](const task_host::HostEvent&) { ++heard; });
        for (int call = 0; call < 10; ++call) {
          (void)(*robot)->snapshot();
          answered.release();
          (*robot)->begin_all({action_of(model::ActionKind::Stop, "a")}, soon(), [](const auto&) {});
        }
      });
    }
    std::thread events([&] {
      while (!over)
        daemon_.robot->tell(task_host::TaskEvent{TaskId("a"), TaskState::Fatal, "why"});
    });
    for (int call = 0; call < round; ++call)
      EXPECT_TRUE(answered.try_acquire_until(soon()));
    server_.reset();
    for (auto& user : users)
      user.join();
    over = true;
    events.join();
    EXPECT_FALSE(daemon_.robot->has_listener());
  }
}

}  // namespace
}  // namespace segue::control
