// SPDX-License-Identifier: Apache-2.0
#include <support/fake_deployment.hpp>

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace segue::control {
namespace {

class ProcessesTest : public ControlTest {
 protected:
  void serve() {
    auto server = Server::listen(socket_, &processes_);
    ASSERT_TRUE(server) << to_string(server.error());
    server_ = std::move(*server);
  }
  std::unique_ptr<process_server::ProcessService> client() {
    return connect_processes(socket_, kLong).value();
  }

  FakeProcesses processes_;
};

TEST_F(ProcessesTest, StartStopAndListTravel) {
  processes_.process.robot = "spot";
  processes_.process.pid = 42;
  processes_.exit.signal = 9;
  serve();
  const auto processes = client();
  process_server::Launch launch;
  launch.robot = "spot";
  launch.deployment.process = model::ProcessName("p");
  launch.libraries = {"a", "b"};
  launch.memory.prefault = 4096;
  EXPECT_EQ(processes->start(launch, soon()).value().pid, 42);
  EXPECT_EQ(processes_.seen()->launched, launch);
  launch.robot = "twice";
  EXPECT_EQ(processes->start(launch, soon()).error().code, ErrorCode::AlreadyExists);
  EXPECT_EQ(processes->stop("spot", {model::kLocalHost, model::ProcessName("p")}, soon()).value().signal, 9);
  EXPECT_EQ(processes_.seen()->asked, "spot:localhost/p");
  ASSERT_TRUE(processes->kill("spot", {model::kLocalHost, model::ProcessName("p")}, soon()));
  EXPECT_EQ(processes_.seen()->asked, "kill spot:localhost/p");
  EXPECT_EQ(processes->processes("spot").value().size(), 2U);
  EXPECT_EQ(connect(socket_, kLong).error().code, ErrorCode::Unsupported);
}

TEST_F(ProcessesTest, EndsOfProcessesAreTold) {
  serve();
  const auto processes = client();
  std::atomic<int> pid{0};
  processes->set_listener([&](const process_server::ProcessInfo& process) { pid = process.pid; });
  process_server::ProcessInfo ended;
  ended.pid = 7;
  processes_.tell(ended);
  EXPECT_TRUE(eventually([&] { return pid == 7; }));
}

}  // namespace
}  // namespace segue::control
