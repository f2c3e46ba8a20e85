// SPDX-License-Identifier: Apache-2.0
// Connections between two deployments in one process, as if each had a process of its own.
#include <segue/deploy/local_deployment.hpp>
#include <segue/task_host/test_support.hpp>
#include <support/eventually.hpp>
#include <support/test_hooks.hpp>

#include <gmock/gmock.h>

#include <atomic>
#include <thread>

namespace pair {

using segue::task::InputPort;
using segue::task::OutputPort;

class Source : public segue::task::Component {
 public:
  OutputPort<std::int64_t> out{*this, "out"};
  OutputPort<std::string> words{*this, "words"};
  Source() : Component({.activity = segue::periodic(std::chrono::milliseconds(1))}) {
    dynamic_outputs<std::int64_t>("extra");
  }

 protected:
  segue::Result<void> on_configure() override {
    extra_ =
        std::make_unique<OutputPort<std::int64_t>>(*this, "extra", segue::task::PortOptions{.dynamic = true});
    return {};
  }
  void on_update() override {
    out.write(++count_);
    extra_->write(count_);
  }
  void on_cleanup() override { extra_.reset(); }

 private:
  std::int64_t count_ = 0;
  std::unique_ptr<OutputPort<std::int64_t>> extra_;
};

/// Samples that all sinks received.
inline std::atomic<std::int64_t> last{0};
inline std::atomic<std::int64_t> backwards{0};

class Sink : public segue::task::Component {
 public:
  InputPort<std::int64_t> in{*this, "in"};
  Sink() { dynamic_inputs<std::int64_t>("extra"); }

 protected:
  segue::Result<void> on_configure() override {
    extra_ =
        std::make_unique<InputPort<std::int64_t>>(*this, "extra", segue::task::PortOptions{.dynamic = true});
    return {};
  }
  void on_update() override {
    std::int64_t value = 0;
    while (in.read(value) == segue::task::ReadStatus::NewData) {
      if (value <= last.load()) ++backwards;
      last = value;
    }
  }
  void on_cleanup() override { extra_.reset(); }

 private:
  std::unique_ptr<InputPort<std::int64_t>> extra_;
};

}  // namespace pair

SEGUE_COMPONENT(pair::Source)
SEGUE_COMPONENT(pair::Sink)

namespace segue::deploy {
namespace {

using model::ActionKind;
using task_host::testing::apply;
using task_host::testing::on_process;
using task_host::testing::on_task;
using task_host::testing::soon;
using task_host::testing::task_of;
using task_host::testing::wire;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// One simulated process.
struct Process {
  explicit Process(std::string_view name) {
    DeploymentInfo info;
    info.deployment.process = model::ProcessName(name);
    key = info.deployment.key();
    auto made = sample_link::SharedMemory::create();
    EXPECT_TRUE(made) << to_string(made.error());
    memory = *made;
    info.incarnation = memory->incarnation();
    deployment = std::make_unique<LocalDeployment>(info, host, memory);
  }

  /// Sequentially.
  void perform(const std::vector<model::Action>& actions) {
    for (const auto& action : actions) {
      const auto done = deployment->perform_all(std::vector{action}, soon()).front();
      EXPECT_TRUE(done) << to_string(done.error());
    }
  }
  void bring_to_running(const model::Task& task) {
    perform({task_host::testing::apply(task, key.process.str()),
             on_task(ActionKind::Configure, task.id.str()), on_task(ActionKind::Start, task.id.str())});
  }
  std::vector<EndpointReport> endpoints() { return deployment->snapshot()->endpoints; }

  model::DeploymentKey key;
  std::shared_ptr<sample_link::SharedMemory> memory;
  model::ComponentCatalog catalog;
  task_host::LibrarySet libraries;
  task_host::LocalTaskHost host{
      libraries, catalog, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}}};
  std::unique_ptr<LocalDeployment> deployment;
};

void admit_peers(Process& a, Process& b) {
  for (auto [to, from] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    const auto offer = from->deployment->memory(soon());
    ASSERT_TRUE(offer);
    ASSERT_TRUE(to->deployment->admit(*offer, soon()));
  }
}

class ConnectedDeployments : public ::testing::Test {
 protected:
  ConnectedDeployments() {
    hooks::reset();
    pair::last = 0;
    pair::backwards = 0;
    admit_peers(p_, q_);
  }
  ~ConnectedDeployments() override { hooks::release_all(); }

  Result<sample_link::OutputOrigin> describe(const model::Connection& connection) {
    const std::vector ports{connection.from};
    return p_.deployment->describe_outputs(ports, soon()).at(0);
  }
  Result<sample_link::InputPlace> open(const model::Connection& connection,
                                       const sample_link::OutputOrigin& origin, TimePoint deadline = soon()) {
    const std::vector<OpenInput> inputs{{connection, origin}};
    return q_.deployment->open_inputs(inputs, deadline).at(0);
  }
  Result<void> attach(const model::Connection& connection, const sample_link::InputPlace& place) {
    const std::vector<AttachOutput> outputs{{connection, place}};
    return p_.deployment->attach_outputs(outputs, soon()).at(0);
  }
  /// Connects p to q in the steps of DeploymentService.
  Result<void> connect(const model::Connection& connection) {
    const auto origin = describe(connection);
    if (!origin) return origin.error();
    const auto place = open(connection, *origin);
    if (!place) return place.error();
    return attach(connection, *place);
  }
  void close(const model::Connection& connection) {
    EXPECT_TRUE(p_.deployment
                    ->close_endpoints(std::vector<CloseEndpoint>{{connection, Side::Output, false,
                                                                  q_.memory->incarnation()}},
                                      soon())
                    .at(0));
    EXPECT_TRUE(
        q_.deployment
            ->close_endpoints(
                std::vector<CloseEndpoint>{{connection, Side::Input, true, p_.memory->incarnation()}}, soon())
            .at(0));
  }
  void expect_refused(const Result<void>& done, ErrorCode code, std::string_view words) {
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().code, code) << to_string(done.error());
    EXPECT_THAT(to_string(done.error()), HasSubstr(words));
  }
  void run_both() {
    q_.bring_to_running(task_of("sink", "pair::Sink"));
    p_.bring_to_running(task_of("source", "pair::Source"));
  }
  /// Until its next read an input may hold the sample that it read last, and with it the ring that contains
  /// it.
  void remove_sink() {
    q_.perform({on_task(ActionKind::Stop, "sink"), on_task(ActionKind::Cleanup, "sink")});
    EXPECT_TRUE(q_.host.perform(on_process(ActionKind::Undeploy, q_.key.process.str()), soon()));
  }
  [[nodiscard]] static bool arrives_after(std::int64_t value) {
    return segue::testing::eventually([value] { return pair::last > value; });
  }

  Process p_{"p"};
  Process q_{"q"};
  const model::Connection flow_ = [] {
    auto connection = wire("source", "out", "sink", "in");
    connection.policy = {BufferKind::Buffer, 64, Transport::Automatic, false};
    return connection;
  }();
};

TEST_F(ConnectedDeployments, carry_samples_between_them) {
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

TEST_F(ConnectedDeployments, refuse_a_connection_that_exists) {
  run_both();
  ASSERT_TRUE(connect(flow_));
  expect_refused(connect(flow_), ErrorCode::AlreadyExists, "source.out -> sink.in");
  const auto place = q_.endpoints().at(0).place;
  expect_refused(attach(flow_, place), ErrorCode::AlreadyExists, "already connected");
  EXPECT_EQ(q_.endpoints().size(), 1U);
  EXPECT_TRUE(arrives_after(10));
}

TEST_F(ConnectedDeployments, leave_nothing_behind_when_connections_are_closed) {
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

TEST_F(ConnectedDeployments, keep_a_place_until_its_writer_is_known_to_be_gone) {
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

TEST_F(ConnectedDeployments, give_stand_ins_the_ports_that_they_lack) {
  q_.bring_to_running(task_of("b", "any::Thing"));
  p_.bring_to_running(task_of("a", "any::Thing"));
  const auto connection = wire("a", "scans", "b", "clouds");
  const auto connected = connect(connection);
  EXPECT_TRUE(connected) << to_string(connected.error());
  EXPECT_EQ(p_.endpoints().size(), 1U);
}

TEST_F(ConnectedDeployments, explain_what_is_missing) {
  run_both();
  expect_refused(connect(wire("sauce", "out", "sink", "in")), ErrorCode::NotFound, "did you mean 'source'");
  expect_refused(connect(wire("source", "ot", "sink", "in")), ErrorCode::NotFound, "did you mean 'out'");
  expect_refused(connect(wire("source", "out", "sink", "im")), ErrorCode::NotFound, "did you mean 'in'");
  expect_refused(connect(wire("source", "out", "drain", "in")), ErrorCode::NotFound, "'drain'");
  EXPECT_THAT(p_.endpoints(), IsEmpty());
  EXPECT_THAT(q_.endpoints(), IsEmpty());
}

TEST_F(ConnectedDeployments, refuse_types_that_do_not_fit) {
  run_both();
  const auto connection = wire("source", "words", "sink", "in");
  expect_refused(connect(connection), ErrorCode::TypeMismatch, "string");
  close(connection);
  EXPECT_EQ(q_.memory->usage().connections, 0U);
}

TEST_F(ConnectedDeployments, refuse_peers_that_are_not_mapped) {
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

TEST_F(ConnectedDeployments, obey_stand_ins_that_refuse_to_be_connected) {
  q_.bring_to_running(task_of("b", "any::Thing"));
  const type::Value behaviour = type::Value::map({{"fail", "connect"}});
  p_.bring_to_running(task_of("a", "any::Thing", type::Value::map({{"stand_in", behaviour}})));
  expect_refused(connect(wire("a", "out", "b", "in")), ErrorCode::HookFailed, "connect");
}

TEST_F(ConnectedDeployments, endpoints_at_dynamic_ports_end_with_them) {
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

TEST_F(ConnectedDeployments, reconnect_where_the_readers_port_was_gone) {
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

TEST_F(ConnectedDeployments, keep_endpoints_when_a_task_gets_another_activity) {
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

TEST_F(ConnectedDeployments, end_what_they_had_with_a_peer_that_is_gone) {
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

TEST_F(ConnectedDeployments, lead_to_two_incarnations_of_a_task_at_once) {
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

TEST_F(ConnectedDeployments, wait_for_hooks_until_the_deadline_only) {
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

TEST_F(ConnectedDeployments, close_their_endpoints_when_they_go_down) {
  run_both();
  ASSERT_TRUE(connect(flow_));
  EXPECT_TRUE(p_.deployment->shut_down(soon()));
  EXPECT_THAT(p_.endpoints(), IsEmpty());
  EXPECT_EQ(p_.memory->usage().connections, 0U);
  EXPECT_TRUE(q_.deployment->shut_down(soon()));
  EXPECT_EQ(q_.memory->usage().connections, 0U);
}

/// Connections are made and closed while samples flow and other threads observe.
TEST_F(ConnectedDeployments, stand_a_storm_of_connections) {
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

/// Does what a runtime does around the commit of a transition that gives `flow_` another policy.
class CommittingDeployments : public ConnectedDeployments {
 protected:
  CommittingDeployments() {
    run_both();
    EXPECT_TRUE(connect(flow_));
    EXPECT_TRUE(arrives_after(pair::last + 10));
  }

  /// Does what actions of Prepare do.
  void prepare(const model::Connection& connection) {
    const auto origin = describe(connection);
    ASSERT_TRUE(origin);
    const std::vector<OpenInput> inputs{{connection, *origin, true}};
    const auto place = q_.deployment->open_inputs(inputs, soon()).at(0);
    ASSERT_TRUE(place) << to_string(place.error());
    const std::vector<AttachOutput> outputs{{connection, *place, true}};
    const auto attached = p_.deployment->attach_outputs(outputs, soon()).at(0);
    ASSERT_TRUE(attached) << to_string(attached.error());
  }
  /// On the page of a runtime; `ending` ends with the commit.
  std::uint64_t arm(const std::shared_ptr<sample_link::CommitPage>& page, const model::Connection& ending) {
    ArmCommit what{page, page->begin(), {}, {}};
    what.endpoints = {{ending, Side::Output, q_.memory->incarnation()}};
    EXPECT_TRUE(p_.deployment->arm_commit(what, soon()));
    what.endpoints = {{ending, Side::Input, p_.memory->incarnation()}};
    EXPECT_TRUE(q_.deployment->arm_commit(what, soon()));
    return what.number;
  }
  void settle() {
    EXPECT_TRUE(p_.deployment->settle(soon()));
    EXPECT_TRUE(q_.deployment->settle(soon()));
  }
  /// The connections that carry samples, by the size of their buffers.
  std::vector<std::size_t> sizes() {
    std::vector<std::size_t> sizes;
    for (const auto& endpoint : q_.endpoints()) {
      if (endpoint.carries) sizes.push_back(endpoint.connection.policy.size);
    }
    return sizes;
  }

  const model::Connection other_ = [this] {
    auto connection = flow_;
    connection.policy.size = 32;
    return connection;
  }();
};

TEST_F(CommittingDeployments, exchange_a_connection_between_two_samples_again_and_again) {
  const auto page = *sample_link::CommitPage::create();
  for (int i = 0; i < 200; ++i) {
    const auto& old = i % 2 == 0 ? flow_ : other_;
    const auto& fresh = i % 2 == 0 ? other_ : flow_;
    prepare(fresh);
    const std::uint64_t number = arm(page, old);
    EXPECT_THAT(sizes(), ElementsAre(old.policy.size));
    page->commit(number);
    EXPECT_THAT(sizes(), ElementsAre(fresh.policy.size)) << "from the store on";
    settle();
    EXPECT_TRUE(arrives_after(pair::last));
    close(old);
  }
  EXPECT_EQ(pair::backwards, 0);
}

TEST_F(CommittingDeployments, go_on_as_before_where_the_runtime_dies_before_the_store) {
  prepare(other_);
  {
    const auto page = *sample_link::CommitPage::create();
    arm(page, flow_);
  }
  EXPECT_TRUE(arrives_after(pair::last + 10)) << "nobody waits for a runtime";
  settle();  // by the next runtime
  EXPECT_THAT(sizes(), ElementsAre(flow_.policy.size));
  close(other_);

  prepare(other_);  // and its own transition, whose number is the same on another page
  const auto page = *sample_link::CommitPage::create();
  const std::uint64_t number = arm(page, flow_);
  page->commit(number);
  settle();
  EXPECT_THAT(sizes(), ElementsAre(other_.policy.size));
  EXPECT_TRUE(arrives_after(pair::last + 10));
  EXPECT_EQ(pair::backwards, 0);
}

TEST_F(CommittingDeployments, have_switched_where_the_runtime_dies_right_after_the_store) {
  prepare(other_);
  {
    const auto page = *sample_link::CommitPage::create();
    page->commit(arm(page, flow_));
  }
  EXPECT_THAT(sizes(), ElementsAre(other_.policy.size));
  EXPECT_TRUE(arrives_after(pair::last + 10));
  settle();  // by the next runtime
  EXPECT_THAT(sizes(), ElementsAre(other_.policy.size));
  EXPECT_TRUE(arrives_after(pair::last + 10));
  close(flow_);
  EXPECT_EQ(pair::backwards, 0);
}

TEST_F(CommittingDeployments, are_not_disturbed_by_the_page_of_a_runtime_that_was_replaced) {
  const auto old_page = *sample_link::CommitPage::create();
  const auto page = *sample_link::CommitPage::create();
  prepare(other_);
  const std::uint64_t number = arm(page, flow_);
  old_page->commit(number);
  EXPECT_THAT(sizes(), ElementsAre(flow_.policy.size));
  page->commit(number);
  EXPECT_THAT(sizes(), ElementsAre(other_.policy.size));
}

}  // namespace
}  // namespace segue::deploy
