// SPDX-License-Identifier: Apache-2.0
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/distributed/distributed_task_host.hpp>

#include <segue/base/text.hpp>
#include <segue/distributed/lease.hpp>
#include <segue/model/files.hpp>
#include <segue/solve/solve.hpp>
#include <segue/task_host/component_library.hpp>
#include <segue/task_host/full_id.hpp>
#include <segue/task_host/local_task_host.hpp>
#include <support/eventually.hpp>
#include <support/fake_hosts.hpp>
#include <support/random_networks.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <future>
#include <random>
#include <thread>

namespace segue::distributed {
namespace {

using namespace std::chrono_literals;
using model::HostName;
using model::Order;
using model::Phase;
using model::TaskId;
using segue::testing::eventually;
using segue::testing::kPatience;

TimePoint later(Duration duration = 30s) {
  return RealClock::instance().now() + duration;
}

model::Network spread_of(std::string_view text) {
  Diagnostics diagnostics;
  auto network = model::read_network(text, "test.yaml", diagnostics);
  EXPECT_TRUE(network) << to_string(diagnostics);
  return network.value_or(model::Network{});
}

const char* const kFirst = R"(network: first
tasks:
  a: {component: test::A}
  b: {component: test::B}
  c: {component: test::C}
  d: {component: test::D}
deployments:
  p1: {process: p1, host: left, tasks: [a, b]}
  p2: {process: p2, host: right, tasks: [c]}
connections:
  - a.out -> b.in
  - a.out -> c.in
  - {from: b.out, to: c.more, policy: buffer, size: 10}
  - c.out -> d.in
  - d.out -> a.in
  - d.out -> c.again
)";

/// b has moved from left to right, c from right to the runtime's own process; e is new, and d reads more.
const char* const kSecond = R"(network: second
tasks:
  a: {component: test::A}
  b: {component: test::B, takes_over: b}
  c: {component: test::C, state: stopped}
  d: {component: test::D}
  e: {component: test::E}
deployments:
  p1: {process: p1, host: left, tasks: [a]}
  p3: {process: p3, host: right, tasks: [b, e]}
  p4: {process: p4, host: workstation, tasks: [d]}
connections:
  - a.out -> b.in
  - a.out -> d.in
  - b.out -> c.in
  - c.out -> e.in
  - d.out -> a.in
)";

std::string said(const Result<void>& result) {
  return result ? "done" : to_string(result.error());
}

/// The computers of a robot: its runtime's own, "left" and "right".
struct Computers {
  deploy::testing::FakeWorld own;
  testing::Computer left{"left"};
  testing::Computer right{"right"};
};

/// A runtime's host over all of them. Nothing is watched unless the test wishes it.
struct Commander {
  explicit Commander(Computers& all, DistributedOptions chosen = {}, Duration watch = 1h,
                     const std::string& holder = "me", model::ComponentCatalog known = {})
      : computers(all), catalog(std::move(known)), options(complete(std::move(chosen), watch, holder)) {
    host.set_listener([this](const task_host::HostEvent& event) {
      if (const auto* computer = std::get_if<task_host::ComputerEvent>(&event)) {
        note(computer->host.str() + (computer->reachable ? " is back" : " is lost"));
      }
      if (std::holds_alternative<task_host::LossEvent>(event)) {
        note("the robot is lost");
      }
    });
  }
  ~Commander() { host.set_listener({}); }

  void note(std::string event) {
    const Lock lock(mutex);
    events.push_back(std::move(event));
    changed.notify_all();
  }

  static DistributedOptions complete(DistributedOptions options, Duration watch, const std::string& holder) {
    const bool take_over = options.request.take_over;
    options.request = testing::request_of(holder, take_over);
    options.gateways.robot = "robot";
    options.gateways.own = {HostName("workstation")};
    options.watch = watch;
    return options;
  }

  /// Switches in the steps in which the runtime does.
  Result<void> switch_to(const model::Network& network) {
    const model::Network observed = host.observe();
    const model::Network target = host.expanded(network);
    const auto transition = plan(observed, target);
    host.begin_transition(observed, target);
    auto done = perform(transition, Phase::Prepare);
    if (done) {
      host.get_ready(target);
      done = host.arm_commit(transition, later());
    }
    if (done) {
      done = perform(transition, Phase::Commit);
    }
    if (done) {
      done = host.commit();
    }
    if (!done) {
      host.withdraw();
      return done;
    }
    done = perform(transition, Phase::Retire);
    host.conclude(transition);
    return done;
  }
  Result<void> switch_to(const char* text) { return switch_to(spread_of(text)); }

  [[nodiscard]] model::Transition plan(const model::Network& observed, const model::Network& target) const {
    const auto transition = solve::diff(observed, target, catalog, {order, host.side_by_side()});
    EXPECT_TRUE(transition) << to_string(transition.error());
    return transition.value_or(model::Transition{});
  }
  Result<void> perform(const model::Transition& transition, Phase phase) {
    std::vector<model::Action> actions;
    for (const auto& action : transition.actions) {
      if (action.phase == phase) {
        actions.push_back(action);
      }
    }
    Result<void> outcome;
    std::size_t reported = 0;
    const std::size_t count = actions.size();
    host.perform_in_order(std::move(actions), 60s, {}, [&](std::vector<task_host::Completed> ended) {
      for (auto& one : ended) {
        ++reported;
        if (outcome && one.begun) {
          outcome = std::move(one.outcome);
        }
      }
    });
    EXPECT_EQ(reported, count);
    return outcome;
  }

  [[nodiscard]] std::string wrong(const model::Network& shall) const {
    return listed(model::differences(host.expanded(shall), host.observe()));
  }
  [[nodiscard]] std::string wrong(const char* shall) const { return wrong(spread_of(shall)); }
  [[nodiscard]] task_host::ComputerReport computer(const std::string& name) const {
    for (auto& report : host.computers()) {
      if (report.name.str() == name) {
        return report;
      }
    }
    return {};
  }
  bool told(const std::string& event) {
    Lock lock(mutex);
    return changed.wait_for(mutex, kPatience,
                            [&] { return std::find(events.begin(), events.end(), event) != events.end(); });
  }

  Computers& computers;
  const model::ComponentCatalog catalog;
  const DistributedOptions options;
  Order order = Order::Seamless;
  Mutex mutex;                ///< protects both below
  ConditionVariable changed;  ///< `events`
  std::vector<std::string> events;
  task_host::LibrarySet libraries;
  task_host::LocalTaskHost local{
      libraries, catalog, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}}};
  deploy::testing::FakeProcesses processes{computers.own};
  deploy::testing::FakeService service{computers.own, computers.own.own()};
  fleet::DeployedTaskHost own{service,
                              processes,
                              deploy::testing::connector(computers.own),
                              testing::request_of("").launch,
                              local,
                              {60s, 1h, {model::kLocalHost, HostName("workstation")}}};
  DistributedTaskHost host{own, {computers.left.place(), computers.right.place(true)}, catalog, options};
};

model::Network none() {
  return {};
}

TEST(DistributedTaskHost, NetworksGoFromHostToHost) {
  for (const Order order : {Order::Paper, Order::Seamless}) {
    Computers computers;
    Commander run(computers);
    run.order = order;
    for (const char* next : {kFirst, kSecond, kFirst}) {
      ASSERT_EQ(said(run.switch_to(next)), "done");
      EXPECT_EQ(run.wrong(next), "");
      EXPECT_TRUE(equivalent(run.host.condensed(run.host.observe()), spread_of(next)));
      EXPECT_EQ(run.host.connections().size(), spread_of(next).connections.size());
      EXPECT_EQ(run.host.tasks().size(), spread_of(next).tasks.size());
    }
    EXPECT_EQ(computers.left.world.find("p1")->tasks.size(), 2U);
    EXPECT_EQ(computers.right.world.find("p2")->tasks.size(), 1U);
    EXPECT_EQ(computers.own.own()->tasks.size(), 1U);
    ASSERT_EQ(said(run.switch_to(none())), "done");
    EXPECT_TRUE(run.host.observe().empty());
    EXPECT_TRUE(computers.left.world.running().empty());
    EXPECT_TRUE(computers.own.running().empty());
  }
}

TEST(DistributedTaskHost, APhaseIsOneMessageForEachHost) {
  Computers computers;
  Commander run(computers);
  ASSERT_EQ(said(run.switch_to(kFirst)), "done");
  const auto calls = [&](const char* what) { return computers.left.line.calls(what); };
  const int before = calls("begin_in_order");
  auto extended = spread_of(kFirst);
  extended.tasks.emplace_back(extended.tasks.front()).id = TaskId("f");
  extended.deployments.front().tasks.emplace_back().task = TaskId("f");
  extended.connections.push_back({{TaskId("f"), "out"}, {TaskId("c"), "f"}, {}, {}});
  for (const char* what : {"begin_transition", "get_ready", "arm_commit", "vote", "commit", "conclude"}) {
    SCOPED_TRACE(what);
    const int others = calls(what);
    ASSERT_EQ(said(run.switch_to(extended)), "done");
    EXPECT_EQ(calls(what), others + 1);
    ASSERT_EQ(said(run.switch_to(kFirst)), "done");
  }
  // f and its sender are created, connected and started in chains of prepare and commit; and taken down
  // again.
  EXPECT_LE(calls("begin_in_order"), before + 6 * 2 * 3);
  EXPECT_EQ(calls("begin_all"), 0);
}

TEST(DistributedTaskHost, NetworksOfAnyKindGoFromHostToHost) {
  for (std::uint64_t seed = 0; seed < 25; ++seed) {
    SCOPED_TRACE(seed);
    segue::testing::Random random(seed);
    const std::array hosts = {"left", "right",
                              segue::testing::one_in(random, 2) ? "localhost" : "workstation"};
    const segue::testing::NetworkShape shape{
        .tasks = 6, .processes = 4, .properties = false, .attributes = false};
    const auto place = [&](model::Network network) {
      for (auto& deployment : network.deployments) {
        deployment.host = HostName(segue::testing::any_of(random, hosts));
        for (auto& placement : deployment.tasks) {
          placement.name = placement.task.str();  // simulated processes know no other names
        }
      }
      for (auto& connection : network.connections) {
        connection.policy.transport = Transport::Automatic;
      }
      return network;
    };
    const auto first = place(segue::testing::random_network(random, shape));
    const auto second = place(segue::testing::random_variation(random, first, shape));
    Computers computers;
    Commander run(computers);
    run.order = segue::testing::one_in(random, 4) ? Order::Paper : Order::Seamless;
    for (const auto* next : {&first, &second, &first}) {
      ASSERT_EQ(said(run.switch_to(*next)), "done");
      ASSERT_EQ(run.wrong(*next), "");
    }
    ASSERT_EQ(said(run.switch_to(none())), "done");
    EXPECT_TRUE(run.host.observe().empty());
  }
}

TEST(DistributedTaskHost, ATaskTakesItsStateToAnotherHost) {
  Computers computers;
  Commander run(computers);
  ASSERT_EQ(said(run.switch_to(kFirst)), "done");
  task::SavedState state;
  state.version = 7;
  const auto p1 = computers.left.world.find("p1");
  computers.left.world.change([&] { p1->states.insert_or_assign(TaskId("b"), state); });
  EXPECT_EQ(run.host.describe(TaskId("b"))->doc, "p1/b");
  ASSERT_EQ(said(run.switch_to(kSecond)), "done");
  EXPECT_EQ(run.host.describe(TaskId("b"))->doc, "p3/b");
  EXPECT_EQ(run.host.details(TaskId("b"))->timing.updates.total(), 1U);
  EXPECT_FALSE(p1->tasks.contains(TaskId("b")));
  ASSERT_TRUE(computers.right.world.find("p3")->states.contains(TaskId("b")));
  EXPECT_EQ(computers.right.world.find("p3")->states.at(TaskId("b")).version, 7U);
}

TEST(DistributedTaskHost, WhatIsWithdrawnLeavesTheFormerNetworkRunning) {
  Computers computers;
  Commander run(computers);
  ASSERT_EQ(said(run.switch_to(kFirst)), "done");
  const auto observed = run.host.observe();
  const auto target = run.host.expanded(spread_of(kSecond));
  const auto transition = run.plan(observed, target);
  run.host.begin_transition(observed, target);
  ASSERT_EQ(said(run.perform(transition, Phase::Prepare)), "done");
  ASSERT_EQ(said(run.host.arm_commit(transition, later())), "done");
  run.host.withdraw();
  EXPECT_EQ(run.host.describe(TaskId("b"))->doc, "p1/b");
  EXPECT_EQ(
      run.host.describe(task_host::full_id(TaskId("b"), {HostName("right"), model::ProcessName("p3")}))->doc,
      "p3/b");
  const auto now = run.host.observe();
  for (const auto& connection : observed.connections) {
    EXPECT_EQ(std::count(now.connections.begin(), now.connections.end(), connection), 1)
        << to_string(connection);
  }
  ASSERT_EQ(said(run.switch_to(kFirst)), "done");
  EXPECT_EQ(run.wrong(kFirst), "");
  ASSERT_EQ(said(run.switch_to(kSecond)), "done");
  EXPECT_EQ(run.wrong(kSecond), "");
}

TEST(DistributedTaskHost, AHostThatIsLostIsMissingUntilItIsBack) {
  Computers computers;
  Commander run(computers, {}, 10ms);
  ASSERT_EQ(said(run.switch_to(kFirst)), "done");
  (void)run.host.tasks();
  computers.left.line.cut();
  ASSERT_TRUE(run.told("left is lost"));
  EXPECT_FALSE(run.computer("left").reachable);
  EXPECT_TRUE(eventually([&] {
    return run.computer("left").state.find("nobody answers") != std::string::npos;
  })) << "once it was looked for: "
      << run.computer("left").state;
  EXPECT_TRUE(run.computer("right").reachable);
  EXPECT_TRUE(run.computer("right").optional);
  const auto observed = run.host.observe();
  EXPECT_EQ(observed.find_task(TaskId("a")), nullptr);
  EXPECT_NE(observed.find_task(TaskId("c")), nullptr);
  for (const auto& report : run.host.tasks()) {
    EXPECT_EQ(report.unknown, report.id.str() == "a" || report.id.str() == "b") << report.id.str();
  }
  const auto asked = run.host.properties(TaskId("a"));
  ASSERT_FALSE(asked);
  EXPECT_EQ(asked.error().code, ErrorCode::Unavailable);
  EXPECT_EQ(asked.error().subject, "a");
  EXPECT_EQ(run.switch_to(kSecond).error().code, ErrorCode::Unavailable);
  computers.left.line.mend();
  ASSERT_TRUE(run.told("left is back"));
  EXPECT_TRUE(run.computer("left").reachable);
  EXPECT_TRUE(run.host.properties(TaskId("a")));
  ASSERT_EQ(said(run.switch_to(kFirst)), "done");
  EXPECT_EQ(run.wrong(kFirst), "") << "what was begun elsewhere is removed";
  ASSERT_EQ(said(run.switch_to(kSecond)), "done");
  EXPECT_EQ(run.wrong(kSecond), "");
}

TEST(DistributedTaskHost, ATaskThatMovedFromALostHostIsReportedOnceUnderItsName) {
  Computers computers;
  Commander run(computers);
  ASSERT_EQ(said(run.switch_to(kFirst)), "done");
  (void)run.host.tasks();
  computers.left.line.cut();
  auto moved = spread_of(kFirst);
  moved.deployments.front().host = HostName("right");
  ASSERT_EQ(said(run.switch_to(moved)), "done");
  int known = 0;
  int unknown = 0;
  for (const auto& report : run.host.tasks()) {
    known += report.id.str() == "a" ? 1 : 0;
    unknown += report.id.str() == "a@left/p1" ? 1 : 0;
    EXPECT_EQ(report.unknown, report.id.str().find("@left") != std::string::npos) << report.id.str();
  }
  EXPECT_EQ(known, 1);
  EXPECT_EQ(unknown, 1);
}

TEST(DistributedTaskHost, AHostThatWasLostMeanwhileTakesNoMoreActionsOfATransition) {
  Computers computers;
  Commander run(computers, {}, 10ms);
  ASSERT_EQ(said(run.switch_to(kFirst)), "done");
  const auto observed = run.host.observe();
  const auto target = run.host.expanded(spread_of(kSecond));
  const auto transition = run.plan(observed, target);
  run.host.begin_transition(observed, target);
  computers.right.line.cut();
  computers.right.line.mend();
  ASSERT_TRUE(eventually([&] { return run.computer("right").reachable; }));
  const auto done = run.perform(transition, Phase::Prepare);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::Unavailable);
  EXPECT_NE(to_string(done.error()).find("'right'"), std::string::npos) << to_string(done.error());
  const auto armed = run.host.arm_commit(transition, later());
  EXPECT_FALSE(armed);
  run.host.withdraw();
  EXPECT_TRUE(run.host.properties(TaskId("c"))) << "outside of the transition it can be asked";
  ASSERT_EQ(said(run.switch_to(kFirst)), "done");
  EXPECT_EQ(run.wrong(kFirst), "");
  ASSERT_EQ(said(run.switch_to(kSecond)), "done");
  EXPECT_EQ(run.wrong(kSecond), "");
}

/// The real time, but for one reading: whoever takes it finds that something has taken long, without anybody
/// waiting.
class ClockWithDelay final : public Clock {
 public:
  [[nodiscard]] TimePoint now() const override {
    const Lock lock(mutex_);
    const TimePoint real = RealClock::instance().now();
    return delayed_ == std::this_thread::get_id() ? (delayed_ = {}, real + delay_) : real;
  }
  void sleep_until(TimePoint when) override { RealClock::instance().sleep_until(when); }
  /// Of the next reading by this thread.
  void delay_this_thread(Duration delay) {
    const Lock lock(mutex_);
    delayed_ = std::this_thread::get_id();
    delay_ = delay;
  }

 private:
  mutable Mutex mutex_;  ///< protects both below
  mutable std::thread::id delayed_;
  Duration delay_{};
};

/// A host over kFirst that is about to go to kSecond, with trouble at the commit.
class CommitTrouble : public ::testing::Test {
 protected:
  CommitTrouble() { EXPECT_EQ(said(run_.switch_to(kFirst)), "done"); }
  DistributedOptions options() const {
    DistributedOptions options;
    options.promise = kPromise;
    options.clock = &clock_;
    return options;
  }
  std::string switched() { return said(run_.switch_to(kMore)); }
  /// The connections of kMore that kFirst lacks.
  [[nodiscard]] bool has(const char* to) const {
    const auto network = run_.host.condensed(run_.host.observe());
    return std::any_of(network.connections.begin(), network.connections.end(),
                       [&](const model::Connection& one) { return to_string(one.to) == to; });
  }
  void reconnect() {
    run_.computers.right.line.spoil_calls({});
    run_.computers.right.line.spoil_answers({});
  }

  static constexpr Duration kPromise = kPatience;
  static constexpr const char* kMore = R"(network: more
tasks:
  a: {component: test::A}
  b: {component: test::B}
  c: {component: test::C}
  d: {component: test::D}
deployments:
  p1: {process: p1, host: left, tasks: [a, b]}
  p2: {process: p2, host: right, tasks: [c]}
connections:
  - a.out -> b.fresh
  - c.out -> c.fresh
  - d.out -> d.fresh
  - a.out -> c.in
)";
  ClockWithDelay clock_;
  Computers computers_;
  Commander run_{computers_, options()};
};

TEST_F(CommitTrouble, WithoutOneVoteNobodyCommits) {
  for (const ErrorCode code : {ErrorCode::InvalidState, ErrorCode::DeadlineExceeded}) {
    computers_.right.line.spoil_call("vote", code);
    const auto done = switched();
    EXPECT_NE(done.find("'right' did not promise"), std::string::npos) << done;
    EXPECT_FALSE(has("b.fresh"));
    EXPECT_FALSE(has("d.fresh"));
    EXPECT_TRUE(has("b.in"));
    reconnect();
  }
}

TEST_F(CommitTrouble, AHostThatIsSilentAfterItsVoteIsNamed) {
  computers_.right.line.spoil_answer("commit", ErrorCode::DeadlineExceeded);
  const auto done = switched();
  EXPECT_NE(done.find("'right' did not confirm the commit"), std::string::npos) << done;
  EXPECT_TRUE(has("b.fresh"));
  EXPECT_FALSE(run_.computer("right").reachable) << "it counts as lost";
}

TEST_F(CommitTrouble, AProcessThatCannotBeArmedDoesNotLoseItsHost) {
  computers_.right.line.spoil_answer("arm_commit", ErrorCode::Unavailable);
  const auto done = switched();
  EXPECT_NE(done.find("'right' cannot prepare to commit"), std::string::npos) << done;
  EXPECT_TRUE(run_.computer("right").reachable);
  reconnect();
  EXPECT_EQ(switched(), "done");
  EXPECT_EQ(run_.wrong(kMore), "");
}

class LateCommit : public CommitTrouble {
 protected:
  /// Calls `pass_time` while a call of that name is on its way to the host on the right.
  void delay(const std::string& which, std::function<void()> pass_time) {
    computers_.right.line.spoil_calls(
        [which, pass_time = std::move(pass_time)](const std::string& what) -> std::optional<Error> {
          if (what == which) {
            pass_time();
          }
          return std::nullopt;
        });
  }
};

TEST_F(LateCommit, IsRefusedByTheHostThatGetsIt) {
  delay("commit", [&] { computers_.right.clock.advance(kPromise + 1s); });
  const auto done = switched();
  EXPECT_NE(done.find("'right'"), std::string::npos) << done;
  EXPECT_NE(done.find("too late"), std::string::npos) << done;
  EXPECT_FALSE(has("c.fresh"));
  EXPECT_TRUE(run_.computer("right").reachable) << "it has answered";
  reconnect();
  EXPECT_EQ(switched(), "done");
  EXPECT_EQ(run_.wrong(kMore), "");
}

TEST_F(LateCommit, DoesNotHappenWhereAPromiseCameLate) {
  // The promise of the others has nearly run out by then.
  delay("vote", [&] { clock_.delay_this_thread(kPromise - 1s); });
  const auto done = switched();
  EXPECT_NE(done.find("'right' did not promise"), std::string::npos) << done;
  EXPECT_FALSE(has("b.fresh")) << "nobody commits";
  EXPECT_FALSE(has("c.fresh"));
}

TEST(DistributedTaskHost, ARuntimeWhoseRobotWasTakenOverCanDoNothingOnOtherHosts) {
  Computers computers;
  Commander former(computers);
  ASSERT_EQ(said(former.switch_to(kFirst)), "done");
  DistributedOptions options;
  {
    const Commander refused(computers, options, 1h, "other");
    const auto commands = refused.host.commands_all();
    ASSERT_FALSE(commands);
    EXPECT_EQ(commands.error().code, ErrorCode::AlreadyExists);
    EXPECT_NE(to_string(commands.error()).find("'me'"), std::string::npos);
  }
  EXPECT_TRUE(former.host.properties(TaskId("a"))) << "it has lost nothing";
  options.request.take_over = true;
  Commander present(computers, options, 1h, "other");
  EXPECT_TRUE(present.host.commands_all());
  EXPECT_FALSE(former.host.properties(TaskId("a")));
  EXPECT_FALSE(former.host.call(TaskId("a"), "op", type::Value(1), later()));
  EXPECT_FALSE(former.switch_to(kSecond));
  EXPECT_EQ(former.host.observe().find_task(TaskId("a")), nullptr);
  former.host.end_processes(later());
  EXPECT_NE(computers.left.world.find("p1"), nullptr);
  EXPECT_NE(present.host.observe().find_task(TaskId("a")), nullptr);
  EXPECT_TRUE(present.host.properties(TaskId("a")));
}

class LostRobot : public ::testing::Test {
 protected:
  static std::string holder_at(testing::Computer& computer) {
    const auto robots = computer.local->robots().value();
    return robots.empty() ? "" : robots.front().holder;
  }
  /// Another runtime takes the robot there, and nowhere else.
  std::shared_ptr<HostedRobot> rival_at(testing::Computer& computer) {
    auto robot = computer.local->acquire(testing::request_of("rival", true), later());
    EXPECT_TRUE(robot) << to_string(robot.error());
    return robot.value_or(nullptr);
  }
  [[nodiscard]] bool is_lost() {
    return eventually([&] { return former_.host.loss().has_value(); });
  }

  Computers computers_;
  Commander former_{computers_, {}, 10ms};
};

TEST_F(LostRobot, IsLostOnAllHostsOnceOneHasGivenItToAnotherRuntime) {
  ASSERT_EQ(said(former_.switch_to(kFirst)), "done");
  const auto rival = rival_at(computers_.left);
  ASSERT_TRUE(former_.told("left is lost"));
  ASSERT_TRUE(former_.told("right is lost"));
  ASSERT_TRUE(former_.host.loss());
  EXPECT_NE(to_string(*former_.host.loss()).find("'rival'"), std::string::npos);
  EXPECT_EQ(former_.host.commands_all().error().code, ErrorCode::Superseded);
  EXPECT_EQ(former_.host.properties(TaskId("c")).error().code, ErrorCode::Superseded) << "on the right";
  EXPECT_EQ(holder_at(computers_.left), "rival");
  EXPECT_TRUE(eventually([&] { return holder_at(computers_.right).empty(); })) << "its lease is given up";
}

TEST_F(LostRobot, IsSaidToBeLostOnceAndBeforeAHostIsGivenUpForIt) {
  const auto rival = rival_at(computers_.left);
  ASSERT_TRUE(former_.told("right is lost"));
  const Lock lock(former_.mutex);
  const auto& events = former_.events;
  EXPECT_EQ(std::count(events.begin(), events.end(), "the robot is lost"), 1);
  EXPECT_LT(std::find(events.begin(), events.end(), "the robot is lost"),
            std::find(events.begin(), events.end(), "right is lost"));
}

TEST_F(LostRobot, IsNotAskedForAgainAlthoughNobodyElseHasIt) {
  auto rival = rival_at(computers_.left);
  ASSERT_TRUE(former_.told("left is lost"));
  ASSERT_TRUE(former_.told("right is lost"));
  ASSERT_TRUE(rival->release());
  ASSERT_TRUE(eventually([&] { return holder_at(computers_.right).empty(); })) << "its lease is given up";
  const int asked = computers_.left.line.calls("acquire") + computers_.right.line.calls("acquire");
  for (testing::Computer* computer : {&computers_.left, &computers_.right}) {
    computer->boot();
    computer->clock.advance(Lease::kValidity);
  }
  const Commander next(computers_, {}, 10ms, "next");
  const int renewed = computers_.left.line.calls("renew");
  ASSERT_TRUE(eventually([&] { return computers_.left.line.calls("renew") >= renewed + 3; }));
  EXPECT_EQ(computers_.left.line.calls("acquire") + computers_.right.line.calls("acquire"), asked + 2)
      << "only the next runtime has asked, once at each host";
}

TEST_F(LostRobot, IsLostAlsoToARuntimeThatHasLeftWhileTheFormerOneWasAway) {
  computers_.left.line.cut();
  ASSERT_TRUE(former_.told("left is lost"));
  ASSERT_TRUE(rival_at(computers_.left)->release());
  EXPECT_FALSE(former_.host.loss()) << "nobody has told it";
  computers_.left.line.mend();
  EXPECT_TRUE(is_lost());
}

TEST_F(LostRobot, IsNotLostByADaemonThatStartsAgain) {
  computers_.left.line.cut();
  ASSERT_TRUE(former_.told("left is lost"));
  computers_.left.boot();
  computers_.left.clock.advance(1h);
  computers_.left.line.mend();
  ASSERT_TRUE(former_.told("left is back"));
  EXPECT_FALSE(former_.host.loss());
}

TEST(DistributedTaskHost, AHostThatAnotherRuntimeHadFirstIsNotALostRobot) {
  Computers computers;
  computers.right.line.cut();
  Commander run(computers, {}, 10ms);
  const auto other = computers.right.local->acquire(testing::request_of("other"), later());
  ASSERT_TRUE(other);
  computers.right.line.mend();
  ASSERT_TRUE(eventually([&] { return run.computer("right").state.find("'other'") != std::string::npos; }));
  EXPECT_FALSE(run.host.loss());
  ASSERT_TRUE((*other)->release());
  EXPECT_TRUE(run.told("right is back")) << "it may have it now";
}

TEST(DistributedTaskHost, AnotherRuntimeMayHaveTheRobotOnceThisOneEnds) {
  Computers computers;
  {
    Commander run(computers);
    ASSERT_EQ(said(run.switch_to(kFirst)), "done");
  }
  const Commander next(computers, {}, 1h, "other");
  EXPECT_TRUE(next.host.commands_all());
  EXPECT_NE(next.host.observe().find_task(TaskId("a")), nullptr) << "processes run on";
}

TEST(DistributedTaskHost, ACallThatFailsLateDoesNotLoseTheNextConnection) {
  Computers computers;
  Commander run(computers, {}, 10ms);
  ASSERT_EQ(said(run.switch_to(kFirst)), "done");
  std::promise<void> entered;
  std::promise<void> release;
  std::atomic<bool> first{true};
  computers.left.line.spoil_calls(
      [&, released = release.get_future().share()](const std::string& what) -> std::optional<Error> {
        if (what != "snapshot" || !first.exchange(false)) {
          return std::nullopt;
        }
        entered.set_value();
        released.wait();
        return fail(ErrorCode::DeadlineExceeded, "injected");
      });
  auto looks = std::async(std::launch::async, [&] { return run.host.observe(); });
  entered.get_future().wait();
  computers.left.line.cut();
  ASSERT_TRUE(run.told("left is lost"));
  computers.left.line.mend();
  ASSERT_TRUE(run.told("left is back"));
  {
    const Lock lock(run.mutex);
    run.events.clear();
  }
  release.set_value();
  EXPECT_EQ(looks.get().find_task(TaskId("a")), nullptr);
  EXPECT_TRUE(run.computer("left").reachable);
  EXPECT_TRUE(run.host.properties(TaskId("a")));
}

/// Breaks a line in the middle of calls, again and again, and mends it at once or when it has been tried in
/// vain.
class Interruptions {
 public:
  explicit Interruptions(testing::Line& line) : line_(line) {}
  void begin() {
    line_.spoil_calls([this](const std::string&) { return during_call(); });
    line_.on_attempt([this] { before_attempt(); });
  }
  void end() {
    line_.spoil_calls({});
    line_.on_attempt({});
    const Lock lock(mutex_);
    over_ = true;
    line_.mend();
  }
  [[nodiscard]] int count() const {
    const Lock lock(mutex_);
    return count_;
  }

 private:
  std::optional<Error> during_call() {
    const Lock lock(mutex_);
    if (over_ || !line_.up() || --calls_ > 0) {
      return std::nullopt;
    }
    ++count_;
    calls_ = 1 + static_cast<int>(random_() % 40);
    attempts_ = static_cast<int>(random_() % 4);
    line_.cut();
    if (attempts_ == 0) {
      line_.mend();
    }
    return random_() % 2 == 0 ? std::optional<Error>(fail(ErrorCode::Unavailable, "injected")) : std::nullopt;
  }
  void before_attempt() {
    const Lock lock(mutex_);
    if (!over_ && !line_.up() && --attempts_ < 0) {
      line_.mend();
    }
  }

  testing::Line& line_;
  mutable Mutex mutex_;  ///< protects everything below
  std::mt19937 random_{20261126};
  int calls_ = 20;    ///< until the line breaks
  int attempts_ = 0;  ///< that are in vain
  int count_ = 0;
  bool over_ = false;
};

TEST(DistributedTaskHost, AHostMayComeAndGoAtAnyTime) {
  Computers computers;
  Interruptions interruptions(computers.right.line);
  Commander run(computers, {}, 2ms);
  ASSERT_EQ(said(run.switch_to(kFirst)), "done");
  interruptions.begin();
  const TimePoint limit = later(kPatience);
  for (int i = 0; i < 10 || (interruptions.count() < 10 && RealClock::instance().now() < limit); ++i) {
    (void)run.switch_to(i % 2 == 0 ? kSecond : kFirst);
    (void)run.host.tasks();
    (void)run.host.computers();
  }
  interruptions.end();
  ASSERT_GE(interruptions.count(), 10);
  ASSERT_TRUE(eventually([&] { return run.computer("right").reachable; }));
  // A runtime plans with what failed transitions have left behind; here all of it is taken down.
  ASSERT_TRUE(eventually([&] {
    const bool done = run.switch_to(kFirst) && run.wrong(kFirst).empty();
    return done || (run.switch_to(none()) && false);
  })) << run.wrong(kFirst);
}

/// Two components of one library, which hosts have in versions of their own.
class CheckHosts : public ::testing::Test {
 protected:
  CheckHosts() {
    for (auto* computer : {&computers_.left, &computers_.right}) {
      computer->libraries = {{"lib", "1234567890abcdef", {model::ComponentName("test::A")}}};
    }
  }
  static model::ComponentCatalog known() {
    model::ComponentCatalog catalog;
    for (const char* name : {"test::A", "test::B"}) {
      model::ComponentModel component;
      component.name = model::ComponentName(name);
      component.library = "lib";
      catalog.add(component);
    }
    return catalog;
  }
  /// "CODE: MESSAGE" of each finding, one a line.
  std::string findings(const std::string& network, DistributedOptions options = {}) {
    const Commander commander(computers_, std::move(options), 1h, "me", known());
    std::string all;
    const Diagnostics found = commander.host.check(spread_of(network));
    for (const auto& finding : found.items()) {
      all += finding.code + ": " + finding.message + "\n";
    }
    return all;
  }
  /// A network of a -> b, both of one component, in these processes.
  static std::string pair(const std::string& component, const std::string& first, const std::string& second,
                          const std::string& policy = "") {
    return "network: pair\ntasks:\n  a: {component: " + component + "}\n  b: {component: " + component +
           "}\ndeployments:\n  one: {" + first + ", tasks: [a]}\n  two: {" + second +
           ", tasks: [b]}\nconnections:\n  - {from: a.out, to: b.in" + policy + "}\n";
  }

  Computers computers_;
};

TEST_F(CheckHosts, FindsNothingWhereAllIsWell) {
  EXPECT_EQ(findings(pair("test::A", "process: p, host: left", "process: p, host: right")), "");
  EXPECT_EQ(findings(pair("test::A", "process: p, host: left", "process: p, host: left", ", link: local")),
            "");
  EXPECT_EQ(
      findings(pair("test::A", "process: p, host: workstation", "process: p, host: right", ", link: dds")),
      "");
}

TEST_F(CheckHosts, FindsHostsThatTheRobotLacks) {
  const auto found = findings(pair("test::A", "process: p, host: left", "process: p, host: lefd"));
  EXPECT_THAT(found, ::testing::HasSubstr("unknown-host: "));
  EXPECT_THAT(found, ::testing::HasSubstr("'left'"));
}

TEST_F(CheckHosts, FindsComponentsThatAHostLacks) {
  const auto text = pair("test::B", "process: p, host: left", "process: p");
  EXPECT_THAT(findings(text), ::testing::AllOf(::testing::HasSubstr("not-installed: task 'a'"),
                                               ::testing::HasSubstr("'lib'")));
  DistributedOptions options;
  options.stand_in = true;
  EXPECT_EQ(findings(text, options), "");
}

TEST_F(CheckHosts, FindsLibrariesThatDiffer) {
  const auto text = pair("test::A", "process: p, host: left", "process: p, host: right");
  computers_.right.libraries.front().digest = "fedcba0987654321";
  EXPECT_THAT(findings(text), ::testing::HasSubstr("library-differs: component library 'lib' differs"));
  computers_.right.architecture = "aarch64";
  EXPECT_EQ(findings(text), "");
}

TEST_F(CheckHosts, FindsLinksThatDoNotLeadFromHostToHost) {
  for (const char* link : {"local", "shm"}) {
    const auto found = findings(
        pair("test::A", "process: p, host: left", "process: p, host: right", std::string(", link: ") + link));
    EXPECT_THAT(found, ::testing::HasSubstr("link: a.out -> b.in")) << link;
  }
  for (const char* link : {"local", "dds"}) {
    const auto found = findings(
        pair("test::A", "process: p, host: left", "process: q, host: left", std::string(", link: ") + link));
    EXPECT_THAT(found, ::testing::HasSubstr("link: a.out -> b.in")) << link;
  }
}

TEST_F(CheckHosts, FindsProcessesThatAreNamedLikeAGateway) {
  EXPECT_THAT(findings(pair("test::A", "process: segue_gateway, host: left", "process: p, host: left")),
              ::testing::HasSubstr("reserved-name: process 'left/segue_gateway'"));
}

TEST(DistributedTaskHost, AHostWithAnotherNameIsNoHostOfTheRobot) {
  Computers computers;
  auto place = computers.left.place();
  place.name = HostName("middle");
  concurrent::ThreadPool pool{"test", {4, 1}};
  detail::RobotLoss loss([](const Error&) {});
  detail::HostLink link(place, pool, loss);
  const auto connected = link.connect(testing::request_of("me"), later());
  ASSERT_FALSE(connected);
  EXPECT_EQ(connected.error().code, ErrorCode::InvalidArgument);
  EXPECT_NE(connected.error().message.find("'left'"), std::string::npos);
  EXPECT_FALSE(link.reachable());
}

}  // namespace
}  // namespace segue::distributed
