// SPDX-License-Identifier: Apache-2.0
#include <segue/base/condition_variable.hpp>
#include <segue/base/file.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/text.hpp>
#include <segue/control/deployment_client.hpp>
#include <segue/process_server/assignment.hpp>
#include <segue/process_server/process_server.hpp>

#include <support/paths.hpp>

#include <gmock/gmock.h>
#include <signal.h>

#include <cstdlib>

namespace segue::deploy {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;
using testing::HasSubstr;

constexpr Duration kPatience = seconds(60);

TimePoint soon() {
  return RealClock::instance().now() + kPatience;
}

class DeploymentProcessTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = "/tmp/segue-test-XXXXXX";
    folder_ = ::mkdtemp(pattern.data());
    ::setenv("XDG_RUNTIME_DIR", folder_.c_str(), 1);
    ::setenv("SEGUE_LIBRARY_PATH", segue::paths::kComponentFolder, 1);
  }
  void TearDown() override {
    for (const int pid : pids_)
      ::kill(-pid, SIGKILL);
    processes_.reset();
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  void serve(process_server::ProcessServerOptions options = {}) {
    options.program = segue::paths::kDeploymentProgram;
    auto made = process_server::ProcessServer::create(options);
    ASSERT_TRUE(made.has_value()) << to_string(made.error());
    processes_ = std::move(*made);
    processes_->set_listener([this](const process_server::ProcessInfo& process) {
      const Lock lock(mutex_);
      ended_.push_back(process);
      changed_.notify_all();
    });
  }

  static process_server::Launch launch() {
    process_server::Launch launch;
    launch.robot = "rover";
    launch.deployment.process = model::ProcessName("drivers");
    launch.libraries = {"segue_components_demo"};
    return launch;
  }

  process_server::ProcessInfo start(const process_server::Launch& what) {
    auto process = processes_->start(what, soon());
    EXPECT_TRUE(process.has_value()) << to_string(process.error());
    if (!process) return {};
    pids_.push_back(process->pid);
    return *process;
  }

  /// The exit status, once it has ended by itself.
  std::optional<process_server::ExitReason> end() {
    Lock lock(mutex_);
    if (!changed_.wait_for(mutex_, kPatience, [&] { return !ended_.empty(); })) return std::nullopt;
    return ended_.front().exit;
  }

  static std::string text_of(const fs::path& file) { return read_file(file).value_or(""); }

  fs::path folder_;
  std::vector<int> pids_;
  std::unique_ptr<process_server::ProcessServer> processes_;
  Mutex mutex_;
  ConditionVariable changed_;
  std::vector<process_server::ProcessInfo> ended_;
};

TEST_F(DeploymentProcessTest, ItServesAndEndsCleanlyOnRequest) {
  serve();
  const auto process = start(launch());
  auto deployment = control::connect_deployment(process.socket, soon(), [] {});
  ASSERT_TRUE(deployment.has_value()) << to_string(deployment.error());
  EXPECT_EQ(deployment->info.robot, "rover");
  EXPECT_EQ(deployment->info.pid, process.pid);
  EXPECT_TRUE(deployment->info.deployment == launch().deployment);
  const auto reason = processes_->stop("rover", process.key, soon());
  ASSERT_TRUE(reason.has_value());
  EXPECT_EQ(to_string(*reason), "ended with status 0") << text_of(process.log);
}

TEST_F(DeploymentProcessTest, AForkOfAZygoteWithLibrariesServesToo) {
  process_server::ProcessServerOptions options;
  options.zygote_libraries = {"segue_components_demo"};
  serve(options);
  const auto process = start(launch());
  auto deployment = control::connect_deployment(process.socket, soon(), [] {});
  ASSERT_TRUE(deployment.has_value()) << to_string(deployment.error()) << text_of(process.log);
  EXPECT_EQ(deployment->info.pid, process.pid);
  const auto reason = processes_->stop("rover", process.key, soon());
  ASSERT_TRUE(reason.has_value());
  EXPECT_EQ(to_string(*reason), "ended with status 0") << text_of(process.log);
}

TEST_F(DeploymentProcessTest, TheLogEndsWithAMissingLibrary) {
  serve();
  process_server::Launch wrong = launch();
  wrong.libraries = {"no_such_library"};
  const auto process = start(wrong);
  const auto reason = end();
  ASSERT_TRUE(reason.has_value());
  EXPECT_EQ(reason->status, process_server::kNoLibrary);
  EXPECT_THAT(text_of(process.log), HasSubstr("no_such_library"));
}

TEST_F(DeploymentProcessTest, ALibraryThatThrowsWhileLoadingEndsTheProcessWithAMessage) {
  ::setenv("SEGUE_LIBRARY_PATH", segue::paths::kTestLibraries, 1);
  serve();
  process_server::Launch wrong = launch();
  wrong.libraries = {"segue_test_throws"};
  const auto process = start(wrong);
  const auto reason = end();
  ASSERT_TRUE(reason.has_value());
  EXPECT_EQ(reason->status, process_server::kNoLibrary) << to_string(*reason);
  EXPECT_THAT(text_of(process.log), HasSubstr("no luck today"));
}

TEST_F(DeploymentProcessTest, ALibraryThatNeedsAPartOfTheProgramUsesTheProgramsOwn) {
  ::setenv("SEGUE_LIBRARY_PATH", segue::paths::kTestLibraries, 1);
  serve();
  process_server::Launch linked = launch();
  linked.libraries = {"segue_test_links"};
  const auto process = start(linked);
  auto deployment = control::connect_deployment(process.socket, soon(), [] {});
  ASSERT_TRUE(deployment.has_value()) << to_string(deployment.error()) << text_of(process.log);
  model::Action create;
  create.kind = model::ActionKind::ApplyConfig;
  model::Task task;
  task.id = model::TaskId("task");
  task.component = model::ComponentName("links::Component");
  create.what = model::ConfigAction{task, process.key, "task"};
  const auto outcomes = deployment->service->perform_all(std::vector{create}, soon());
  ASSERT_EQ(outcomes.size(), 1U);
  EXPECT_TRUE(outcomes[0]) << to_string(outcomes[0].error());
  EXPECT_THAT(text_of(process.log), HasSubstr("code from segue-deployment\n"));
  EXPECT_TRUE(processes_->stop("rover", process.key, soon()).has_value());
}

TEST_F(DeploymentProcessTest, MissingProcessorsAreRefused) {
  serve();
  process_server::Launch wrong = launch();
  wrong.deployment.cpus = {1000};
  const auto process = start(wrong);
  const auto reason = end();
  ASSERT_TRUE(reason.has_value());
  EXPECT_EQ(reason->status, process_server::kNotPermitted);
  EXPECT_THAT(text_of(process.log), HasSubstr("processors"));
}

TEST_F(DeploymentProcessTest, WithoutASocketFolderNothingStarts) {
  serve();
  ::setenv("XDG_RUNTIME_DIR", "/nowhere", 1);
  EXPECT_FALSE(processes_->start(launch(), soon()).has_value());
}

}  // namespace
}  // namespace segue::deploy
