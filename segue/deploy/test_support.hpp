// SPDX-License-Identifier: Apache-2.0
#pragma once

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

inline void admit_peers(Process& a, Process& b) {
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

}  // namespace segue::deploy
