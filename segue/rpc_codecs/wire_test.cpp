// SPDX-License-Identifier: Apache-2.0
#include <segue/rpc_codecs/deployment_wire.hpp>
#include <support/random_actions.hpp>

#include <capnp/message.h>
#include <capnp/serialize.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace segue::control::detail {
namespace {

using segue::testing::everything;
using segue::testing::Random;

/// Through a message and back.
template <class Wire, class Thing>
Thing travel(const Thing& thing) {
  capnp::MallocMessageBuilder message;
  encode(thing, message.initRoot<Wire>());
  const auto words = capnp::messageToFlatArray(message);
  capnp::ReaderOptions options;
  options.nestingLimit = kMessageNesting;
  capnp::FlatArrayMessageReader reader(words, options);
  return decode(reader.getRoot<Wire>());
}

RC_GTEST_PROP(WireTest, NetworksTravelUnchanged, (std::uint64_t seed)) {
  Random random(seed);
  const auto network = segue::testing::random_network(random, everything());
  RC_ASSERT(travel<wire::Network>(network) == network);
}

RC_GTEST_PROP(WireTest, ActionsAndTransitionsTravelUnchanged, (std::uint64_t seed)) {
  Random random(seed);
  const auto transition = segue::testing::random_transition(random);
  RC_ASSERT(travel<wire::Transition>(transition) == transition);
}

model::ComponentModel random_component(Random& random) {
  const auto text = [&random] { return segue::testing::random_text(random, true); };
  const auto flag = [&random] { return segue::testing::one_in(random, 2); };
  model::ComponentModel model;
  model.name = model::ComponentName(text());
  model.doc = text();
  model.library = text();
  model.abstract = flag();
  model.incomplete = flag();
  model.own_activity = flag();
  model.parent = text();
  model.activity = segue::testing::random_activity(random);
  for (int i = segue::testing::up_to(random, 3); i > 0; --i) {
    const auto direction = flag() ? model::Direction::Input : model::Direction::Output;
    model.ports.push_back({text(), direction, text(), flag(), flag(), text()});
    model.properties.push_back({text(), text(), segue::testing::random_value(random, true), flag(), text()});
    model.operations.push_back({text(), {{text(), text(), text()}}, text(), flag(), text()});
    model.trigger_ports.push_back(text());
    model.descriptors.push_back(text());
    model.nominal_states.push_back(text());
    model.error_states.push_back(text());
    model.exclusive.push_back(text());
  }
  return model;
}

RC_GTEST_PROP(WireTest, ComponentModelsTravelUnchanged, (std::uint64_t seed)) {
  Random random(seed);
  const auto model = random_component(random);
  RC_ASSERT(travel<wire::Component>(model) == model);
}

model::Connection some_connection() {
  return {{model::TaskId("a"), "out"},
          {model::TaskId("b"), "in"},
          {BufferKind::CircularBuffer, 12, Transport::SharedMemory, true},
          {}};
}

sample_link::InputPlace some_place() {
  return {UINT64_MAX, 2, 3, true, "/Pose", 4, "{x: double}", "b.in", "topic /a"};
}

void expect_same(const sample_link::InputPlace& a, const sample_link::InputPlace& b) {
  EXPECT_EQ(
      std::tie(a.reader, a.offset, a.generation, a.any_type, a.type, a.hash, a.definition, a.port, a.topic),
      std::tie(b.reader, b.offset, b.generation, b.any_type, b.type, b.hash, b.definition, b.port, b.topic));
}

TEST(WireTest, ReportsOfTasksTravelWithTheirTiming) {
  deploy::Snapshot sent;
  Activity activity;
  activity.trigger = Trigger::Periodic;
  activity.period = std::chrono::milliseconds(10);
  task::Timing timing;
  timing.cycles = 1;
  timing.missed = 2;
  timing.last = Duration(3);
  timing.mean = Duration(4);
  timing.worst = Duration(5);
  timing.latency_mean = Duration(6);
  timing.latency_worst = Duration(7);
  timing.jitter = Duration(8);
  timing.cpu = Duration(9);
  sent.tasks.push_back({model::TaskId("a"),
                        model::ComponentName("demo::A"),
                        {model::HostName("base"), model::ProcessName("p")},
                        42,
                        TaskState::Exception,
                        "SLOW",
                        "it threw",
                        true,
                        activity,
                        timing});
  const auto got = travel<wire::Snapshot>(sent);
  ASSERT_EQ(got.tasks.size(), 1U);
  const task_host::TaskReport& a = sent.tasks[0];
  const task_host::TaskReport& b = got.tasks[0];
  EXPECT_EQ(std::tie(a.id, a.component, a.process, a.pid, a.state, a.state_name, a.error, a.stand_in),
            std::tie(b.id, b.component, b.process, b.pid, b.state, b.state_name, b.error, b.stand_in));
  EXPECT_EQ(a.activity, b.activity);
  const task::Timing& t = b.timing;
  EXPECT_EQ(
      std::tie(t.cycles, t.missed, t.last, t.mean, t.worst, t.latency_mean, t.latency_worst, t.jitter, t.cpu),
      std::tie(timing.cycles, timing.missed, timing.last, timing.mean, timing.worst, timing.latency_mean,
               timing.latency_worst, timing.jitter, timing.cpu));
}

TEST(WireTest, HistogramsTravelWithoutTheBinsThatHaveNothing) {
  task_host::TaskDetails sent;
  EXPECT_EQ(travel<wire::Details>(sent).timing, sent.timing);
  auto& updates = sent.timing.updates.counts;
  updates.front() = 1;
  updates[5] = UINT64_MAX;
  sent.timing.latencies.counts.back() = 2;
  EXPECT_EQ(travel<wire::Details>(sent).timing, sent.timing);
  capnp::MallocMessageBuilder message;
  encode(sent, message.initRoot<wire::Details>());
  auto details = message.getRoot<wire::Details>();
  EXPECT_EQ(details.getUpdates().getCounts().size(), 6U);
  EXPECT_EQ(details.getLatencies().getCounts().size(), 1U);
}

TEST(WireTest, LinesOfALogTravel) {
  task_host::TaskDetails sent;
  sent.log.push_back({7, std::chrono::system_clock::now(), LogLevel::Error, "it broke"});
  sent.log.push_back({UINT64_MAX, {}, LogLevel::Debug, ""});
  EXPECT_EQ(travel<wire::Details>(sent).log, sent.log);
  capnp::MallocMessageBuilder message;
  auto details = message.initRoot<wire::Details>();
  details.initLog(1)[0].setLevel(200);
  EXPECT_THROW(decode(details.asReader()), WireError);
}

TEST(WireTest, AHistogramWithBinsBeyondTheLastIsRefused) {
  capnp::MallocMessageBuilder message;
  auto details = message.initRoot<wire::Details>();
  auto updates = details.initUpdates();
  updates.setFirst(task::DurationHistogram::kBins);
  EXPECT_NO_THROW(decode(details.asReader()));
  updates.initCounts(1);
  EXPECT_THROW(decode(details.asReader()), WireError);
}

TEST(WireTest, SnapshotsTravelWithConnectionsEndpointsAndMemory) {
  Random random(11);
  deploy::Snapshot sent;
  sent.network = segue::testing::random_network(random, everything());
  sent.connections.push_back({some_connection(), 1, 2, 3, {4, Duration(5), Duration(6), Duration(7)}});
  sent.endpoints.push_back({some_connection(), deploy::Side::Input, 99, some_place(), {4, 5, 6, 7}});
  sent.endpoints[0].latency = {UINT64_MAX, Duration(8), Duration(9), Duration(10)};
  sent.memory = {1, 2, 3, 4, 5};
  sent.hanging = {model::TaskId("h1"), model::TaskId("h2")};
  const auto got = travel<wire::Snapshot>(sent);
  EXPECT_EQ(got.network, sent.network);
  EXPECT_EQ(got.hanging, sent.hanging);
  ASSERT_EQ(got.connections.size(), 1U);
  const auto& connection = got.connections[0];
  EXPECT_EQ(connection.connection, some_connection());
  EXPECT_EQ(std::tuple(connection.written, connection.read, connection.dropped), std::tuple(1U, 2U, 3U));
  EXPECT_EQ(connection.latency, sent.connections[0].latency);
  EXPECT_EQ(got.endpoints.at(0).latency, sent.endpoints[0].latency);
  ASSERT_EQ(got.endpoints.size(), 1U);
  const auto& endpoint = got.endpoints[0];
  EXPECT_EQ(endpoint.connection, some_connection());
  EXPECT_EQ(std::tuple(endpoint.side, endpoint.peer), std::tuple(deploy::Side::Input, 99U));
  expect_same(endpoint.place, some_place());
  EXPECT_EQ(std::tuple(endpoint.counters.written, endpoint.counters.read, endpoint.counters.dropped,
                       endpoint.counters.overwritten),
            std::tuple(4U, 5U, 6U, 7U));
  const sample_link::MemoryUsage& memory = got.memory;
  EXPECT_EQ(std::tuple(memory.payload_used, memory.payload_touched, memory.control_used, memory.connections,
                       memory.peers),
            std::tuple(1U, 2U, 3U, 4U, 5U));
}

TEST(WireTest, ProcessesTravelWithTheirExit) {
  process_server::ProcessInfo sent{
      "spot", {model::HostName("base"), model::ProcessName("p")},       42, "/run/p.sock", "/log/p.log",
      true,   process_server::ExitReason{1, 2, true, false, true, true}};
  const auto got = travel<wire::ProcessInfo>(sent);
  EXPECT_EQ(std::tie(got.robot, got.key, got.pid, got.socket, got.log, got.adopted),
            std::tie(sent.robot, sent.key, sent.pid, sent.socket, sent.log, sent.adopted));
  ASSERT_TRUE(got.exit);
  EXPECT_EQ(std::tuple(got.exit->status, got.exit->signal, got.exit->core_dumped, got.exit->known,
                       got.exit->requested, got.exit->killed),
            std::tuple(1, 2, true, false, true, true));
  sent.exit.reset();
  EXPECT_FALSE(travel<wire::ProcessInfo>(sent).exit);
}

TEST(WireTest, AnActionWithAnothersSubjectIsRefused) {
  capnp::MallocMessageBuilder message;
  auto action = message.initRoot<wire::Action>();
  action.setKind(static_cast<std::uint8_t>(model::ActionKind::Connect));
  action.setTask("a");
  EXPECT_THROW(decode(action.asReader()), WireError);
}

TEST(WireTest, WordsThatAreNotKnownAreRefused) {
  capnp::MallocMessageBuilder message;
  auto root = message.initRoot<wire::Snapshot>();
  auto connection = root.initConnections(1)[0].initConnection();
  connection.setKind(3);
  EXPECT_THROW(decode(root.asReader()), WireError);
  connection.setKind(2);
  EXPECT_NO_THROW(decode(root.asReader()));
  connection.setTransport(77);
  EXPECT_THROW(decode(root.asReader()), WireError);
  connection.setTransport(0);
  root.initTasks(1)[0].setState(6);
  EXPECT_THROW(decode(root.asReader()), WireError);
}

}  // namespace
}  // namespace segue::control::detail
