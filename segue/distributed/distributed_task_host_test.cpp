// SPDX-License-Identifier: Apache-2.0
#include <segue/distributed/test_support.hpp>

namespace segue::distributed {
namespace {

TEST(DistributedTaskHost, NetworksGoFromHostToHost) {
  for (const Order order : {Order::Paper, Order::Seamless}) {
    Computers computers;
    Commander run(computers);
    run.order = order;
    for (const char* next : {kFirst, kSecond, kFirst}) {
      ASSERT_EQ(said(run.switch_to(next)), "done");
      EXPECT_EQ(run.wrong(next), "");
      EXPECT_TRUE(equivalent(run.host.condensed(run.host.observe()), network_of(next)));
      EXPECT_EQ(run.host.connections().size(), network_of(next).connections.size());
      EXPECT_EQ(run.host.tasks().size(), network_of(next).tasks.size());
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
  auto extended = network_of(kFirst);
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
  const auto target = run.host.expanded(network_of(kSecond));
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
  auto moved = network_of(kFirst);
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
  const auto target = run.host.expanded(network_of(kSecond));
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
    const Diagnostics found = commander.host.check(network_of(network));
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
