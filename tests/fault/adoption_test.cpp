// SPDX-License-Identifier: Apache-2.0
// Deployment processes outlive their runtime and are adopted by the next one.
#include <support/paths.hpp>

#include <fstream>
#include <iterator>

#include "deployed_robot.hpp"

namespace segue::testing {
namespace {

using runtime::EventKind;

class Adoption : public DeployedRobotTest {
 protected:
  /// Starts the process by another version of Segue.
  void start_other_version(const std::string& deployment) {
    process_server::ProcessServerOptions options;
    options.program = segue::paths::kOtherVersionProgram;
    auto server = process_server::ProcessServer::create(options);
    ASSERT_TRUE(server) << to_string(server.error());
    process_server::Launch launch = launch_;
    launch.deployment.process = model::ProcessName(deployment);
    const auto started = (*server)->start(launch, RealClock::instance().now() + std::chrono::seconds(60));
    ASSERT_TRUE(started) << to_string(started.error());
  }

  const model::Network plain_ = network("plain");
};

TEST_F(Adoption, FindsEverythingUnchangedAndDisturbsNothing) {
  const auto working = network("working", "  relay: {component: \"fault::Relay\", properties: {gain: 3}}\n",
                               "  work: {tasks: [relay], cpu: [0]}\n",
                               "  - {from: beater.out, to: relay.in, policy: buffer, size: 100}\n");
  switch_to(working);
  expect_undisturbed();
  const auto before = deployments();
  life_.reset();
  EXPECT_EQ(deployments(), before) << "they outlive their runtime";
  begin_life();
  auto without_witness = working;  // it lived in the runtime's own process
  std::erase_if(without_witness.tasks, [](const auto& task) { return task.id.str() == "witness"; });
  std::erase_if(without_witness.connections,
                [](const auto& connection) { return connection.to.task.str() == "witness"; });
  EXPECT_TRUE(equivalent(host().observe(), without_witness))
      << ::testing::PrintToString(differences(host().observe(), without_witness));
  EXPECT_EQ(deployments(), before);
  expect_undisturbed();
  switch_to(working);
  EXPECT_EQ(deployments(), before);
  expect_undisturbed();
  expect_undisturbed("witness");
}

TEST_F(Adoption, DoesNotGrowOverManyRestarts) {
  switch_to(plain_);
  life_.reset();
  begin_life();
  switch_to(plain_);
  life_.reset();
  const pid_t heart = pid_of("heart");
  const Holdings before = holdings_of(heart);
  for (int i = 0; i < 5; ++i) {
    begin_life();
    switch_to(plain_);
    life_.reset();
  }
  begin_life();
  recover_to(plain_);
  expect_undisturbed();
  life_.reset();
  EXPECT_EQ(pid_of("heart"), heart);
  begin_life();
  recover_to(plain_);
  EXPECT_TRUE(eventually([&] { return holdings_of(heart).memory_maps <= before.memory_maps + 2; }))
      << to_string(before) << " have become " << to_string(holdings_of(heart));
}

TEST_F(Adoption, ReplacesAProcessOfAnotherVersion) {
  switch_to(plain_);
  life_.reset();
  kill("eye");
  start_other_version("eye");
  // It can be found once it has written its identity.
  ASSERT_TRUE(eventually([&] {
    std::ifstream record(folder_ / "segue" / "patient" / "eye.sock.lock");
    const std::string text{std::istreambuf_iterator<char>(record), {}};
    return pid_of("eye") > 0 && text.find("software 0.0.1\n") != std::string::npos;
  }));
  const pid_t old = pid_of("eye");
  begin_life();
  expect_event(EventKind::Process, "0.0.1");
  recover_to(plain_);
  EXPECT_NE(pid_of("eye"), old);
  EXPECT_GT(pid_of("eye"), 0);
  expect_undisturbed();
}

TEST_F(Adoption, TakesAProcessThatDiedMeanwhileAsGone) {
  switch_to(plain_);
  life_.reset();
  kill("eye");
  begin_life();
  EXPECT_EQ(host().observe().find_task(model::TaskId("watcher")), nullptr);
  recover_to(plain_);
  expect_undisturbed();
}

}  // namespace
}  // namespace segue::testing
