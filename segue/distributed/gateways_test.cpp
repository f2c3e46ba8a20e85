// SPDX-License-Identifier: Apache-2.0
#include <segue/distributed/gateways.hpp>
#include <segue/distributed/link_counts.hpp>

#include <segue/base/text.hpp>
#include <segue/task_host/full_id.hpp>
#include <support/network_of.hpp>
#include <support/random_networks.hpp>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <set>

namespace segue::distributed {
namespace {

using model::TaskId;
using segue::testing::network_of;

SampleType no_type(const model::Task& /*writer*/, const std::string& /*port*/) {
  return {};
}

GatewaySettings gateways_of(std::string robot = "spot") {
  GatewaySettings settings;
  settings.robot = std::move(robot);
  return settings;
}

model::Network expand(model::Network network, const GatewaySettings& settings = gateways_of()) {
  return with_gateways(std::move(network), settings, no_type);
}

const model::Task& task_of(const model::Network& network, const std::string& id) {
  static const model::Task none;
  const auto* found = network.find_task(TaskId(id));
  EXPECT_NE(found, nullptr) << "no task " << id;
  return found == nullptr ? none : *found;
}

std::string property_of(const model::Network& network, const std::string& id, const std::string& name) {
  const auto* value = task_of(network, id).properties.as_map().find(name);
  EXPECT_NE(value, nullptr) << name;
  return value == nullptr     ? ""
         : value->is_string() ? value->as_string()
                              : std::to_string(static_cast<int>(value->as_double()));
}

std::set<std::string> links(const model::Network& network) {
  std::set<std::string> ids;
  for (const auto& task : network.tasks) {
    if (is_link_task(task.id)) {
      ids.insert(task.id.str());
    }
  }
  return ids;
}

std::string process_of(const model::Network& network, const std::string& task) {
  const auto processes = model::task_processes(network);
  const auto found = processes.find(TaskId(task));
  return found == processes.end() ? "" : to_string(found->second);
}

const char* const kSpread = R"(network: spread
tasks:
  a: {component: test::A}
  b: {component: test::B}
  c: {component: test::C}
  d: {component: test::D}
deployments:
  one: {process: p, host: left, tasks: [a]}
  two: {process: p, host: right, tasks: [b, c]}
connections:
  - a.out -> b.in
  - a.out -> c.in
  - a.out -> d.in
  - {from: a.out, to: d.more, policy: buffer, size: 8}
  - b.out -> c.other
  - d.out -> a.in
)";

TEST(Gateways, OneSenderServesAllReadersWithOnePolicy) {
  const auto spread = network_of(kSpread);
  const auto whole = expand(spread);
  EXPECT_EQ(links(whole),
            (std::set<std::string>{"a.out>", "a.out>>right", "a.out>>localhost", "a.out>buffer_8",
                                   "a.out>buffer_8>localhost", "d.out>", "d.out>>left"}));
  EXPECT_EQ(process_of(whole, "a.out>"), "left/segue_gateway");
  EXPECT_EQ(process_of(whole, "a.out>>right"), "right/segue_gateway");
  EXPECT_EQ(process_of(whole, "a.out>>localhost"), process_of(whole, "d.out>"));
  EXPECT_EQ(whole.deployments.size(), 5U) << "one gateway on each host";
  EXPECT_EQ(whole.connections.size(), 9U);
  EXPECT_NE(property_of(whole, "a.out>", "topic"), property_of(whole, "a.out>buffer_8", "topic"));
  EXPECT_EQ(property_of(whole, "a.out>", "topic"), property_of(whole, "a.out>>right", "topic"));
  EXPECT_EQ(property_of(whole, "a.out>buffer_8", "policy"), "buffer");
  EXPECT_EQ(property_of(whole, "a.out>buffer_8>localhost", "size"), "8");
  EXPECT_TRUE(equivalent(without_gateways(whole), spread));
}

TEST(Gateways, WhoWantsTheLastSampleHasASenderOfItsOwn) {
  const auto whole = expand(network_of(R"(network: spread
tasks:
  a: {component: test::A}
  b: {component: test::B}
deployments:
  one: {process: p, host: left, tasks: [a]}
connections:
  - a.out -> b.in
  - {from: a.out, to: b.more, policy: data, init: true}
)"));
  EXPECT_EQ(links(whole),
            (std::set<std::string>{"a.out>", "a.out>>localhost", "a.out>_init", "a.out>_init>localhost"}));
  EXPECT_NE(property_of(whole, "a.out>", "topic"), property_of(whole, "a.out>_init", "topic"));
}

TEST(Gateways, EachHalfStaysOnItsHost) {
  const auto whole = expand(network_of(kSpread));
  const auto processes = model::task_processes(whole);
  const auto host_of = [&](const TaskId& task) {
    const auto found = processes.find(task);
    return found == processes.end() ? model::kLocalHost : found->second.host;
  };
  for (const auto& connection : whole.connections) {
    EXPECT_EQ(host_of(connection.from.task), host_of(connection.to.task)) << to_string(connection);
  }
}

TEST(Gateways, ANetworkOnOneHostStaysAsItIs) {
  auto network = network_of(kSpread);
  for (auto& deployment : network.deployments) {
    deployment.host = model::kLocalHost;
  }
  EXPECT_EQ(expand(network), network);
  for (auto& deployment : network.deployments) {
    deployment.host = model::HostName("workstation");
  }
  auto settings = gateways_of();
  settings.own = {model::HostName("workstation")};
  EXPECT_EQ(expand(network, settings), network) << "own names of the runtime's computer are one host";
  EXPECT_NE(expand(network), network);
  EXPECT_EQ(expand(model::Network{}), model::Network{});
}

TEST(Gateways, NetworksOnSeveralHostsHaveThemWithoutConnectionsToo) {
  auto network = network_of(kSpread);
  network.connections.clear();
  const auto whole = expand(network);
  EXPECT_TRUE(links(whole).empty());
  EXPECT_EQ(whole.deployments.size(), 5U);
  EXPECT_EQ(without_gateways(whole), network);
}

TEST(Gateways, TwiceIsOnce) {
  const auto whole = expand(network_of(kSpread));
  EXPECT_EQ(expand(whole), whole);
}

TEST(Gateways, IdsThatDifferHaveTopicsThatDiffer) {
  auto network = network_of(R"(network: similar
tasks:
  left-arm: {component: test::A}
  left_arm: {component: test::A}
  left.arm: {component: test::A}
  d: {component: test::D}
deployments:
  one: {process: p, host: left, tasks: [left-arm, left_arm, left.arm]}
connections:
  - {from: left-arm.out, to: d.a}
  - {from: left_arm.out, to: d.b}
)");
  model::Connection dotted = network.connections.front();
  dotted.from.task = TaskId("left.arm");
  dotted.to.port = "c";
  network.connections.push_back(dotted);
  const auto whole = expand(network);
  std::set<std::string> topics;
  for (const auto& id : links(whole)) {
    if (!sender_of(TaskId(id))) {
      topics.insert(property_of(whole, id, "topic"));
    }
  }
  EXPECT_EQ(topics.size(), 3U) << "else one task's samples would reach the readers of another";
  EXPECT_TRUE(topics.contains("spot/left_arm/out"));
  EXPECT_NE(property_of(expand(network, gateways_of("a-b")), "left_arm.out>", "topic"),
            property_of(expand(network, gateways_of("a.b")), "left_arm.out>", "topic"));
}

TEST(Gateways, AProcessThatAFileNamesLikeAGatewayIsNotForgotten) {
  auto network = network_of(kSpread);
  network.deployments.front().process = kGatewayProcess;
  EXPECT_EQ(without_gateways(network), network) << "so that it can be refused";
}

TEST(Gateways, SamplesHaveTheTypeOfTheirPort) {
  auto settings = gateways_of();
  settings.domain = 7;
  settings.addresses = {{model::HostName("left"), "10.0.0.1"}, {model::HostName("right"), "10.0.0.2"}};
  const auto whole =
      with_gateways(network_of(kSpread), settings, [](const model::Task& writer, const std::string& port) {
        return SampleType{"/" + writer.id.str() + "/" + port, "lib_" + writer.id.str()};
      });
  for (const char* id : {"a.out>", "a.out>>right", "a.out>buffer_8"}) {
    EXPECT_EQ(property_of(whole, id, "type"), "/a/out");
    EXPECT_EQ(property_of(whole, id, "library"), "lib_a");
    EXPECT_EQ(property_of(whole, id, "domain"), "7");
  }
  EXPECT_EQ(property_of(whole, "a.out>", "interface"), "10.0.0.1");
  EXPECT_EQ(property_of(whole, "a.out>>right", "interface"), "10.0.0.2");
  EXPECT_EQ(property_of(whole, "d.out>", "interface"), "");
}

TEST(Gateways, TasksStayAsTheyAreWhereTheRuntimeMovesAndHostsAreAdded) {
  auto settings = gateways_of();
  settings.addresses = {{model::HostName("left"), "10.0.0.1"}, {model::HostName("right"), "10.0.0.2"}};
  const auto before = expand(network_of(kSpread), settings);
  settings.addresses.emplace(model::kLocalHost, "10.0.0.3");
  settings.addresses.emplace(model::HostName("added"), "10.0.0.4");
  const auto after = expand(network_of(kSpread), settings);
  for (const char* id : {"a.out>", "a.out>>right", "a.out>buffer_8"})
    EXPECT_EQ(task_of(after, id), task_of(before, id));
}

TEST(Gateways, IdsAreThoseThatNoFileCanHave) {
  for (const auto& id : links(expand(network_of(kSpread)))) {
    EXPECT_FALSE(is_identifier(id)) << id;
    EXPECT_TRUE(is_link_task(TaskId(id)));
  }
  EXPECT_FALSE(is_link_task(TaskId("a.out")));
  EXPECT_EQ(sender_of(TaskId("a.out>buffer_8>right")), TaskId("a.out>buffer_8"));
  EXPECT_EQ(sender_of(TaskId("a.out>>right")), TaskId("a.out>"));
  EXPECT_EQ(sender_of(TaskId("a.out>")), std::nullopt);
  EXPECT_EQ(sender_of(TaskId("a")), std::nullopt);
  const model::DeploymentKey process{model::HostName("right"), kGatewayProcess};
  EXPECT_TRUE(is_link_task(task_host::full_id(TaskId("a.out>"), process)));
  EXPECT_EQ(sender_of(task_host::full_id(TaskId("a.out>>right"), process)), TaskId("a.out>"));
}

TEST(Gateways, AConnectionIsThereWhereBothHalvesAre) {
  const auto spread = network_of(kSpread);
  const auto whole = expand(spread);
  const auto count = [](const model::Network& network, const char* to) {
    return std::count_if(network.connections.begin(), network.connections.end(),
                         [&](const model::Connection& one) { return to_string(one.to) == to; });
  };
  for (const auto& [from, to] : {std::pair("a.out", "a.out>.in"), std::pair("a.out>>right.out", "b.in")}) {
    auto part = whole;
    const auto erased =
        std::erase_if(part.connections, [&from = from, &to = to](const model::Connection& one) {
          return to_string(one.from) == from && to_string(one.to) == to;
        });
    EXPECT_EQ(erased, 1U);
    const auto seen = without_gateways(part);
    EXPECT_EQ(count(seen, "b.in"), 0);
    EXPECT_EQ(count(seen, "a.in"), 1);
    EXPECT_EQ(count(seen, "d.more"), 1) << "that has another policy";
    EXPECT_EQ(seen.tasks.size(), 4U);
  }
}

task_host::ConnectionReport counted(const char* from, const char* to, std::uint64_t written,
                                    std::uint64_t read, std::uint64_t dropped) {
  task_host::ConnectionReport report;
  report.connection.from = {TaskId(from), "out"};
  report.connection.to = {TaskId(to), "in"};
  report.written = written;
  report.read = read;
  report.dropped = dropped;
  return report;
}

TEST(Gateways, SamplesAreCountedFromWriterToReader) {
  detail::LinkCounts counts;
  counts.note(
      {counted("a", "a.out>", 0, 0, 0), counted("a.out>>r", "b", 0, 0, 0), counted("a.out>>r", "c", 0, 0, 0)},
      true);
  const auto whole = counts.condense({counted("a", "a.out>", 100, 98, 2), counted("a.out>>r", "b", 90, 80, 5),
                                      counted("a.out>>r", "c", 99, 99, 0), counted("b", "c", 7, 6, 1),
                                      counted("x.out>>r", "b", 3, 3, 0), counted("y", "y.out>", 3, 3, 0)});
  ASSERT_EQ(whole.size(), 3U) << "halves without the other one are not connections";
  EXPECT_EQ(to_string(whole[0].connection), "a.out -> b.in");
  EXPECT_EQ(whole[0].written, 100U);
  EXPECT_EQ(whole[0].read, 80U);
  EXPECT_EQ(whole[0].dropped, 2U + 8U + 5U);
  EXPECT_EQ(to_string(whole[1].connection), "a.out -> c.in");
  EXPECT_EQ(whole[1].dropped, 2U) << "a receiver that counts more than was sent has dropped nothing";
  EXPECT_EQ(to_string(whole[2].connection), "b.out -> c.in");
  EXPECT_EQ(whole[2].dropped, 1U);
}

using Halves = std::vector<task_host::ConnectionReport>;

Halves halves(std::uint64_t taken, std::uint64_t delivered) {
  return {counted("a", "a.out>", taken, taken, 0), counted("a.out>>r", "b", delivered, delivered, 0)};
}

TEST(Gateways, LatenciesOfTheHalvesAddUp) {
  using namespace std::chrono_literals;
  detail::LinkCounts counts;
  Halves both = halves(10, 10);
  counts.note(both, true);
  both[0].latency = {5, 1us, 2us, 2us};
  EXPECT_EQ(counts.condense(both).at(0).latency, sample_link::Latency{}) << "nothing has arrived yet";
  both[1].latency = {3, 10us, 20us, 15us};
  EXPECT_EQ(counts.condense(both).at(0).latency, (sample_link::Latency{3, 11us, 22us, 17us}));
}

TEST(Gateways, WhatASenderTookBeforeTheReceiverWasThereWasNotForIt) {
  detail::LinkCounts counts;
  counts.note({counted("a", "a.out>", 1000, 1000, 0)}, true);
  counts.note({counted("a", "a.out>", 1010, 1010, 0), counted("a.out>>r", "b", 4, 4, 0)}, true);
  const auto whole =
      counts.condense({counted("a", "a.out>", 1020, 1020, 0), counted("a.out>>r", "b", 13, 12, 0)});
  ASSERT_EQ(whole.size(), 1U);
  EXPECT_EQ(whole[0].written, 14U);
  EXPECT_EQ(whole[0].dropped, 1U);
}

TEST(Gateways, WhatIsLostWhileAHostIsLostIsCounted) {
  for (const auto& seen : {Halves{counted("a", "a.out>", 150, 150, 0)},
                           Halves{counted("a.out>>r", "b", 100, 100, 0)}, Halves{}}) {
    detail::LinkCounts counts;
    counts.note(halves(100, 90), true);
    counts.note(seen, false);
    counts.note(halves(200, 120), true);
    const auto whole = counts.condense(halves(200, 120));
    ASSERT_EQ(whole.size(), 1U);
    EXPECT_EQ(whole[0].dropped, 70U);
    EXPECT_EQ(whole[0].written, 190U);
  }
}

TEST(Gateways, WhatIsLostIsCountedAlthoughAHalfIsMadeAnew) {
  for (const auto& [taken, delivered] : {std::pair(200U, 20U), std::pair(30U, 120U)}) {
    detail::LinkCounts counts;
    counts.note(halves(0, 0), true);
    counts.note(halves(100, 90), true);
    counts.note({}, false);
    counts.note(halves(taken, delivered), true);
    const auto whole = counts.condense(halves(taken, delivered));
    ASSERT_EQ(whole.size(), 1U);
    EXPECT_EQ(whole[0].written, whole[0].read + whole[0].dropped);
  }
}

TEST(Gateways, AConnectionThatIsMadeAgainCountsFromZero) {
  detail::LinkCounts counts;
  counts.note(halves(100, 50), true);
  counts.note({}, true);
  counts.note(halves(300, 50), true);
  const auto whole = counts.condense(halves(310, 60));
  ASSERT_EQ(whole.size(), 1U);
  EXPECT_EQ(whole[0].dropped, 0U);
}

/// Processes on three hosts and in the runtime's own; no links, which check() refuses between hosts.
model::Network random_spread(segue::testing::Random& random) {
  auto network = segue::testing::random_network(random, {.tasks = 12, .processes = 6, .connections = 24});
  for (auto& deployment : network.deployments) {
    deployment.host = model::HostName(std::array{"localhost", "left", "right", "base"}.at(
        static_cast<std::size_t>(segue::testing::up_to(random, 3))));
  }
  for (auto& connection : network.connections) {
    connection.policy.transport = Transport::Automatic;
  }
  return network;
}

RC_GTEST_PROP(GatewaysOfAnyNetwork, ComeAndGo, (std::uint64_t seed)) {
  segue::testing::Random random(seed);
  const auto network = random_spread(random);
  auto settings = gateways_of();
  if (segue::testing::one_in(random, 2)) {
    settings.own = {model::HostName("base")};
  }
  const auto whole = expand(network, settings);
  RC_ASSERT(equivalent(without_gateways(whole), network));
  RC_ASSERT(equivalent(expand(whole, settings), whole));
  RC_ASSERT(equivalent(expand(without_gateways(whole), settings), whole));
  const auto processes = model::task_processes(whole);
  const auto host_of = [&](const TaskId& task) {
    const auto found = processes.find(task);
    const auto host = found == processes.end() ? model::kLocalHost : found->second.host;
    return std::find(settings.own.begin(), settings.own.end(), host) != settings.own.end() ? model::kLocalHost
                                                                                           : host;
  };
  for (const auto& connection : whole.connections) {
    RC_ASSERT(host_of(connection.from.task) == host_of(connection.to.task));
  }
}

RC_GTEST_PROP(GatewaysOfAnyNetwork, AreOneForEachPortPolicyAndHost, (std::uint64_t seed)) {
  segue::testing::Random random(seed);
  const auto whole = expand(random_spread(random));
  std::set<TaskId> ids;
  std::set<model::DeploymentKey> keys;
  std::set<std::string> topics;
  for (const auto& task : whole.tasks) {
    RC_ASSERT(ids.insert(task.id).second);
    if (is_link_task(task.id) && !sender_of(task.id)) {
      RC_ASSERT(topics.insert(task.properties.as_map().find("topic")->as_string()).second);
    }
  }
  for (const auto& task : whole.tasks) {
    if (const auto sender = sender_of(task.id)) {
      RC_ASSERT(ids.contains(*sender));
    }
  }
  for (const auto& deployment : whole.deployments) {
    if (deployment.process == kGatewayProcess) {
      RC_ASSERT(keys.insert(deployment.key()).second);
    }
  }
}

}  // namespace
}  // namespace segue::distributed
