// SPDX-License-Identifier: Apache-2.0
#include <segue/base/descriptor.hpp>

#include <poll.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "../support/sanitizer_reports.hpp"
#include "deployed_robot.hpp"

#include <segue/model/files.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/sample_link/shared_memory.hpp>
#include <segue/task_host/component_library.hpp>

#include <support/eventually.hpp>
#include <support/paths.hpp>
#include <support/sanitizers.hpp>

#include <cstdlib>

#include <csignal>
#include <cstdlib>

namespace segue::testing {

namespace {

namespace fs = std::filesystem;
using type::Value;

constexpr const char* kLibrary = "segue_test_faults";
}  // namespace

RobotLife::RobotLife(const process_server::Launch& launch,
                     std::unique_ptr<process_server::ProcessService> processes,
                     const fleet::DeployedOptions& options)
    : processes_(std::move(processes)) {
  EXPECT_TRUE(libraries_.load(kLibrary));
  auto models = libraries_.export_models(kLibrary, catalog_.types());
  EXPECT_TRUE(models);
  for (auto& model : *models)
    catalog_.add(std::move(model));
  auto memory = sample_link::SharedMemory::create(launch.memory);
  EXPECT_TRUE(memory);
  local_ = std::make_unique<task_host::LocalTaskHost>(
      libraries_, catalog_, task_host::LocalOptions{launch.stand_in, launch.only_stand_ins, {}});
  deploy::DeploymentInfo info;
  info.robot = launch.robot;
  info.pid = ::getpid();
  info.software = SEGUE_VERSION;
  info.incarnation = (*memory)->incarnation();
  own_ = std::make_unique<deploy::LocalDeployment>(info, *local_, *memory);
  host_ = std::make_unique<fleet::DeployedTaskHost>(*own_, *processes_, control::connect_deployment, launch,
                                                    *local_, options);
  asking_ = std::make_unique<AskingHost>(*host_);
  runtime_ = std::make_unique<runtime::Runtime>(launch.robot, *asking_, catalog_);
}

std::unique_ptr<process_server::ProcessService> DeployedRobotTest::make_processes() {
  process_server::ProcessServerOptions options;
  options.program = segue::paths::kDeploymentProgram;
  auto server = process_server::ProcessServer::create(options);
  EXPECT_TRUE(server) << to_string(server.error());
  return std::move(*server);
}

void DeployedRobotTest::SetUp() {
  std::string pattern = ::testing::TempDir() + "segue-fault-XXXXXX";
  ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
  folder_ = pattern;
  ::setenv("XDG_RUNTIME_DIR", folder_.c_str(), 1);
  ::setenv("SEGUE_LIBRARY_PATH", segue::paths::kTestLibraries, 1);
  collect_sanitizer_reports(folder_);
  launch_.robot = "patient";
  launch_.libraries = {kLibrary};
  begin_life();
}

void DeployedRobotTest::TearDown() {
  if (life_ != nullptr) {
    const auto ended = try_switch(model::Network{}, std::chrono::seconds(10));
    EXPECT_EQ(ended.outcome, runtime::Outcome::Done) << ended.why();
  }
  life_.reset();
  expect_nothing_left(folder_);
  EXPECT_EQ(sanitizer_reports(folder_), "");
  fs::remove_all(folder_);
}

model::Network DeployedRobotTest::network(const std::string& name, const std::string& tasks,
                                          const std::string& deployments, const std::string& connections) {
  const std::string text = "network: " + name + "\ntasks:\n" + kChainTasks + tasks + "deployments:\n" +
                           kChainDeployments + deployments + "connections:\n" + kChainConnections +
                           connections;
  Diagnostics diagnostics;
  auto network = model::read_network(text, name, diagnostics);
  EXPECT_TRUE(network) << to_string(diagnostics);
  return network.value_or(model::Network{});
}

runtime::SwitchResult DeployedRobotTest::try_switch(const model::Network& target, Duration action_deadline) {
  runtime::RequestOptions options;
  options.action_deadline = action_deadline;
  return runtime().switch_to(target, options);
}

void DeployedRobotTest::switch_to(const model::Network& target) {
  const auto result = try_switch(target);
  ASSERT_EQ(result.outcome, runtime::Outcome::Done) << result.why();
  EXPECT_TRUE(equivalent(host().observe(), target))
      << ::testing::PrintToString(differences(host().observe(), target));
}

int DeployedRobotTest::number_of_switches() {
  constexpr int kSwitches = kSanitized ? 12 : 100;
  const char* wanted = std::getenv("SEGUE_FAULT_SWITCHES");
  return wanted == nullptr ? kSwitches : std::atoi(wanted);
}

void DeployedRobotTest::recover_to(const model::Network& target) {
  runtime::SwitchResult last;
  const bool recovered = eventually([&] {
    last = try_switch(target);
    return last.outcome == runtime::Outcome::Done && equivalent(host().observe(), target);
  });
  EXPECT_TRUE(recovered) << last.why() << ::testing::PrintToString(differences(host().observe(), target));
}

void DeployedRobotTest::kill(const std::string& deployment) {
  const pid_t pid = pid_of(deployment);
  ASSERT_GT(pid, 0) << "there is no process " << deployment;
  // Memory is released before locks and sockets, and the first thread ends before the others: wait for the
  // end of the process.
  const Descriptor process(static_cast<int>(::syscall(SYS_pidfd_open, pid, 0)));
  ASSERT_TRUE(process.valid());
  ::kill(pid, SIGKILL);
  pollfd end{process.get(), POLLIN, 0};
  EXPECT_EQ(::poll(&end, 1, 60'000), 1);
  EXPECT_TRUE(eventually([&] { return pid_of(deployment) != pid; }));
}

Sight DeployedRobotTest::sight(const std::string& watcher) {
  const auto deadline = RealClock::instance().now() + kPatience;
  const auto report = host().call(model::TaskId(watcher), "report", Value(), deadline);
  EXPECT_TRUE(report) << to_string(report.error());
  return report ? Sight::of(*report) : Sight{};
}

void DeployedRobotTest::expect_undisturbed(const std::string& watcher) {
  testing::expect_undisturbed(watcher, [&] { return sight(watcher); });
}

void DeployedRobotTest::expect_event(runtime::EventKind kind, const std::string& words) {
  const bool came = eventually([&] {
    for (const auto& event : runtime().events()) {
      const std::string text = event.subject + ": " + event.message;
      if (event.kind == kind && text.find(words) != std::string::npos) return true;
    }
    return false;
  });
  std::string all;
  for (const auto& event : runtime().events())
    all += std::string(to_string(event.kind)) + ' ' + event.subject + ": " + event.message + '\n';
  EXPECT_TRUE(came) << "no such event with '" << words << "' among\n" << all;
}

}  // namespace segue::testing
