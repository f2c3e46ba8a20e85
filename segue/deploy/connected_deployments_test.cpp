// SPDX-License-Identifier: Apache-2.0
#include <segue/deploy/test_support.hpp>

namespace segue::deploy {
namespace {

TEST_F(ConnectedDeployments, CarrySamplesBetweenThem) {
  run_both();
  const auto connected = connect(flow_);
  ASSERT_TRUE(connected) << to_string(connected.error());
  EXPECT_TRUE(arrives_after(pair::last + 100));
  EXPECT_EQ(pair::backwards, 0);
  const auto outputs = p_.endpoints();
  const auto inputs = q_.endpoints();
  ASSERT_EQ(outputs.size(), 1U);
  ASSERT_EQ(inputs.size(), 1U);
  EXPECT_EQ(outputs[0].connection, flow_);
  EXPECT_EQ(outputs[0].side, Side::Output);
  EXPECT_EQ(outputs[0].peer, q_.memory->incarnation());
  EXPECT_EQ(inputs[0].side, Side::Input);
  EXPECT_EQ(inputs[0].peer, p_.memory->incarnation());
  EXPECT_EQ(outputs[0].place.offset, inputs[0].place.offset);
  EXPECT_EQ(outputs[0].place.generation, inputs[0].place.generation);
  EXPECT_GT(outputs[0].counters.written, 10U);
  EXPECT_GT(inputs[0].counters.read, 10U);
  EXPECT_THAT(p_.deployment->snapshot()->network.connections, IsEmpty())
      << "only one of its endpoints is there";
  EXPECT_EQ(p_.deployment->snapshot()->memory.connections, 1U);
}

TEST_F(ConnectedDeployments, RefuseAConnectionThatExists) {
  run_both();
  ASSERT_TRUE(connect(flow_));
  expect_refused(connect(flow_), ErrorCode::AlreadyExists, "source.out -> sink.in");
  const auto place = q_.endpoints().at(0).place;
  expect_refused(attach(flow_, place), ErrorCode::AlreadyExists, "already connected");
  EXPECT_EQ(q_.endpoints().size(), 1U);
  EXPECT_TRUE(arrives_after(10));
}

TEST_F(ConnectedDeployments, LeaveNothingBehindWhenConnectionsAreClosed) {
  const auto idle = q_.memory->usage().control_used;
  run_both();
  ASSERT_TRUE(connect(flow_));
  ASSERT_TRUE(arrives_after(10));
  close(flow_);
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(connect(flow_));
    close(flow_);
  }
  close(flow_);  // closing again has no effect
  EXPECT_THAT(p_.endpoints(), IsEmpty());
  EXPECT_THAT(q_.endpoints(), IsEmpty());
  remove_sink();
  EXPECT_EQ(q_.memory->usage().control_used, idle);
  EXPECT_EQ(q_.memory->usage().connections, 0U);
  EXPECT_EQ(p_.memory->usage().connections, 0U);
}

TEST_F(ConnectedDeployments, KeepAPlaceUntilItsWriterIsKnownToBeGone) {
  const auto idle = q_.memory->usage().control_used;
  run_both();
  ASSERT_TRUE(connect(flow_));
  const auto used = q_.memory->usage().control_used;
  const std::vector<CloseEndpoint> reader{{flow_, Side::Input, false, p_.memory->incarnation()}};
  EXPECT_TRUE(q_.deployment->close_endpoints(reader, soon()).at(0));
  EXPECT_THAT(q_.endpoints(), IsEmpty());
  EXPECT_EQ(q_.memory->usage().control_used, used) << "the writer may still write into it";
  close(flow_);
  remove_sink();
  EXPECT_EQ(q_.memory->usage().control_used, idle);
}

TEST_F(ConnectedDeployments, GiveStandInsThePortsThatTheyLack) {
  q_.bring_to_running(task_of("b", "any::Thing"));
  p_.bring_to_running(task_of("a", "any::Thing"));
  const auto connection = wire("a", "scans", "b", "clouds");
  const auto connected = connect(connection);
  EXPECT_TRUE(connected) << to_string(connected.error());
  EXPECT_EQ(p_.endpoints().size(), 1U);
}

TEST_F(ConnectedDeployments, ExplainWhatIsMissing) {
  run_both();
  expect_refused(connect(wire("sauce", "out", "sink", "in")), ErrorCode::NotFound, "did you mean 'source'");
  expect_refused(connect(wire("source", "ot", "sink", "in")), ErrorCode::NotFound, "did you mean 'out'");
  expect_refused(connect(wire("source", "out", "sink", "im")), ErrorCode::NotFound, "did you mean 'in'");
  expect_refused(connect(wire("source", "out", "drain", "in")), ErrorCode::NotFound, "'drain'");
  EXPECT_THAT(p_.endpoints(), IsEmpty());
  EXPECT_THAT(q_.endpoints(), IsEmpty());
}

TEST_F(ConnectedDeployments, RefuseTypesThatDoNotFit) {
  run_both();
  const auto connection = wire("source", "words", "sink", "in");
  expect_refused(connect(connection), ErrorCode::TypeMismatch, "string");
  close(connection);
  EXPECT_EQ(q_.memory->usage().connections, 0U);
}

TEST_F(ConnectedDeployments, RefusePeersThatAreNotMapped) {
  run_both();
  auto origin = describe(flow_);
  ASSERT_TRUE(origin);
  origin->writer += 1;
  const auto opened = open(flow_, *origin);
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::InvalidState);
  sample_link::InputPlace place;
  place.reader = 12345;
  expect_refused(attach(flow_, place), ErrorCode::InvalidState, "admitted");
}

TEST_F(ConnectedDeployments, ObeyStandInsThatRefuseToBeConnected) {
  q_.bring_to_running(task_of("b", "any::Thing"));
  const type::Value behaviour = type::Value::map({{"fail", "connect"}});
  p_.bring_to_running(task_of("a", "any::Thing", type::Value::map({{"stand_in", behaviour}})));
  expect_refused(connect(wire("a", "out", "b", "in")), ErrorCode::HookFailed, "connect");
}

TEST_F(ConnectedDeployments, EndpointsAtDynamicPortsEndWithThem) {
  run_both();
  const auto input = wire("source", "out", "sink", "extra");
  const auto output = wire("source", "extra", "sink", "in");
  ASSERT_TRUE(connect(input));
  ASSERT_TRUE(connect(output));
  q_.perform({on_task(ActionKind::Stop, "sink"), on_task(ActionKind::Cleanup, "sink")});
  ASSERT_EQ(q_.endpoints().size(), 1U);
  EXPECT_EQ(q_.endpoints().front().connection, output);
  p_.perform({on_task(ActionKind::Stop, "source"), on_task(ActionKind::Cleanup, "source")});
  ASSERT_EQ(p_.endpoints().size(), 1U);
  EXPECT_EQ(p_.endpoints().front().connection, input);
}

TEST_F(ConnectedDeployments, ReconnectWhereTheReadersPortWasGone) {
  run_both();
  const auto connection = wire("source", "out", "sink", "extra");
  ASSERT_TRUE(connect(connection));
  const auto before = q_.endpoints().front().place;
  q_.perform({on_task(ActionKind::Stop, "sink"), on_task(ActionKind::Cleanup, "sink"),
              on_task(ActionKind::Configure, "sink"), on_task(ActionKind::Start, "sink")});
  const auto again = connect(connection);
  ASSERT_TRUE(again) << to_string(again.error());
  ASSERT_EQ(p_.endpoints().size(), 1U) << "the endpoint to the old place is gone";
  EXPECT_NE(p_.endpoints().front().place.generation, before.generation);
  close(connection);
  EXPECT_EQ(q_.memory->usage().connections, 0U);
}

TEST_F(ConnectedDeployments, KeepEndpointsWhenATaskGetsAnotherActivity) {
  run_both();
  ASSERT_TRUE(connect(flow_));
  ASSERT_TRUE(arrives_after(10));
  auto sink = task_of("sink", "pair::Sink");
  sink.activity = Activity{Trigger::Periodic, std::chrono::milliseconds(2), {}, 0, {}, {}, false};
  q_.perform({on_task(ActionKind::Stop, "sink"), on_task(ActionKind::Cleanup, "sink"), apply(sink, "q"),
              on_task(ActionKind::Configure, "sink"), on_task(ActionKind::Start, "sink")});
  EXPECT_EQ(q_.endpoints().size(), 1U);
  EXPECT_TRUE(arrives_after(pair::last + 10));
  EXPECT_EQ(pair::backwards, 0);
}

TEST_F(ConnectedDeployments, EndWhatTheyHadWithAPeerThatIsGone) {
  run_both();
  ASSERT_TRUE(connect(flow_));
  EXPECT_TRUE(q_.deployment->forget(p_.memory->incarnation()));
  EXPECT_THAT(q_.endpoints(), IsEmpty());
  EXPECT_EQ(q_.memory->usage().connections, 0U);
  EXPECT_EQ(q_.memory->usage().peers, 0U);
  const auto origin = describe(flow_);
  ASSERT_TRUE(origin);
  EXPECT_FALSE(open(flow_, *origin)) << "it is a stranger now";
}

TEST_F(ConnectedDeployments, LeadToTwoIncarnationsOfATaskAtOnce) {
  run_both();
  ASSERT_TRUE(connect(flow_));
  Process other("r");
  other.bring_to_running(task_of("sink", "pair::Sink"));
  ASSERT_TRUE(p_.deployment->admit(*other.deployment->memory(soon()), soon()));
  ASSERT_TRUE(other.deployment->admit(*p_.deployment->memory(soon()), soon()));
  const auto origin = describe(flow_);
  ASSERT_TRUE(origin);
  const auto place = other.deployment->open_inputs(std::vector<OpenInput>{{flow_, *origin}}, soon()).at(0);
  ASSERT_TRUE(place) << to_string(place.error());
  ASSERT_TRUE(attach(flow_, *place));
  ASSERT_EQ(p_.endpoints().size(), 2U);
  EXPECT_NE(p_.endpoints()[0].peer, p_.endpoints()[1].peer);
  EXPECT_FALSE(attach(flow_, *place)) << "each of them once";
  close(flow_);
  ASSERT_EQ(p_.endpoints().size(), 1U) << "the other one stands";
  EXPECT_EQ(p_.endpoints().front().peer, other.memory->incarnation());
  EXPECT_THAT(q_.endpoints(), IsEmpty());
  EXPECT_TRUE(arrives_after(pair::last + 10)) << "what is written arrives there";
}

TEST_F(ConnectedDeployments, WaitForHooksUntilTheDeadlineOnly) {
  p_.bring_to_running(task_of("source", "pair::Source"));
  const auto origin = describe(flow_);
  ASSERT_TRUE(origin);
  const auto stuck = task_of("sink", "hooks::Stuck", type::Value::map({{"hook", "configure"}}));
  q_.perform({apply(stuck, "q")});
  std::thread caller([&] { q_.perform({on_task(ActionKind::Configure, "sink")}); });
  ASSERT_TRUE(hooks::wait_until_inside("sink"));
  const auto opened = open(flow_, *origin, RealClock::instance().now() + std::chrono::milliseconds(5));
  EXPECT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::DeadlineExceeded);
  hooks::release("sink");
  caller.join();
}

TEST_F(ConnectedDeployments, CloseTheirEndpointsWhenTheyGoDown) {
  run_both();
  ASSERT_TRUE(connect(flow_));
  EXPECT_TRUE(p_.deployment->shut_down(soon()));
  EXPECT_THAT(p_.endpoints(), IsEmpty());
  EXPECT_EQ(p_.memory->usage().connections, 0U);
  EXPECT_TRUE(q_.deployment->shut_down(soon()));
  EXPECT_EQ(q_.memory->usage().connections, 0U);
}

/// Connections are made and closed while samples flow and other threads observe.
TEST_F(ConnectedDeployments, StandAStormOfConnections) {
  run_both();
  std::atomic<bool> over = false;
  std::thread looker([&] {
    while (!over) {
      for (auto* process : {&p_, &q_}) {
        EXPECT_LE(process->endpoints().size(), 2U);
      }
    }
  });
  auto other = flow_;
  other.policy = {BufferKind::Data, 1, Transport::Automatic, false};
  std::thread second([&] {
    for (int i = 0; i < 100; ++i) {
      EXPECT_TRUE(connect(other));
      close(other);
    }
  });
  for (int i = 0; i < 100; ++i) {
    EXPECT_TRUE(connect(flow_));
    close(flow_);
  }
  second.join();
  over = true;
  looker.join();
  ASSERT_TRUE(connect(flow_));
  EXPECT_TRUE(arrives_after(pair::last + 10));
}

}  // namespace
}  // namespace segue::deploy
