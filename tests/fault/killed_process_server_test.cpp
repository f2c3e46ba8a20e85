// SPDX-License-Identifier: Apache-2.0
// The process server of the computer is killed before every action of a transition in turn; its successor
// finds the processes again.
#include <segue/runtime/daemon_processes.hpp>

#include <support/paths.hpp>

#include <csignal>

#include "../system/process.hpp"
#include "disturbed_transition.hpp"

namespace segue::testing {
namespace {

namespace fs = std::filesystem;

class KilledProcessServer : public DisturbedTransition {
 protected:
  void TearDown() override {
    const auto ended = try_switch(model::Network{}, std::chrono::seconds(10));
    EXPECT_EQ(ended.outcome, runtime::Outcome::Done) << ended.why();
    life_.reset();
    daemon_->signal(SIGTERM);
    EXPECT_EQ(daemon_->wait().status, 0);
    DisturbedTransition::TearDown();
  }
  std::unique_ptr<process_server::ProcessService> make_processes() override {
    start();
    auto connected = runtime::DaemonProcesses::connect(
        launch_.robot, [this] { return control::connect_processes(folder_ / "segue/host.sock"); });
    EXPECT_TRUE(connected) << to_string(connected.error());
    return std::move(*connected);
  }
  void start() {
    daemon_ = std::make_unique<Process>(std::vector<std::string>{segue::paths::kProgram, "host"}, folder_);
    ASSERT_TRUE(daemon_->wait_for(" is running (pid "));
  }
  void kill_server() {
    daemon_->signal(SIGKILL);
    EXPECT_EQ(daemon_->wait().status, 128 + SIGKILL);
  }

  std::unique_ptr<Process> daemon_;
};

TEST_F(KilledProcessServer, BeforeEveryAction) {
  before_every_action(
      "the process server is killed", [&](std::size_t) { kill_server(); }, [&] { start(); });
  expect_undisturbed();
  expect_undisturbed("witness");
}

}  // namespace
}  // namespace segue::testing
