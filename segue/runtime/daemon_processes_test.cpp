// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/daemon_processes.hpp>

#include <gtest/gtest.h>

namespace segue::runtime {
namespace {

/// State that the process servers of a computer share with the test.
struct Computer {
  int opened = 0;
  int calls = 0;
  bool one_runs = true;
  int living = 0;  ///< the number of the running process server
  process_server::ProcessService::Listener listener;
  ErrorCode start_fails = ErrorCode::AlreadyExists;
};

class FakeDaemon final : public process_server::ProcessService {
 public:
  FakeDaemon(Computer& computer, int number) : computer_(computer), number_(number) {}

  Result<process_server::ProcessInfo> start(const process_server::Launch& /*launch*/,
                                            TimePoint /*deadline*/) override {
    ++computer_.calls;
    return fail(lives() ? computer_.start_fails : ErrorCode::Unavailable, "no");
  }
  Result<process_server::ExitReason> stop(const std::string& /*robot*/, const model::DeploymentKey& /*key*/,
                                          TimePoint /*deadline*/) override {
    if (lives()) return process_server::ExitReason{};
    return fail(ErrorCode::Unavailable, "gone");
  }
  Result<process_server::ExitReason> kill(const std::string& robot, const model::DeploymentKey& key,
                                          TimePoint deadline) override {
    return stop(robot, key, deadline);
  }
  Result<std::vector<process_server::ProcessInfo>> processes(const std::string& /*robot*/) override {
    if (lives()) return std::vector<process_server::ProcessInfo>(static_cast<std::size_t>(number_));
    return fail(ErrorCode::Unavailable, "gone");
  }
  void set_listener(Listener listener) override {
    if (lives()) computer_.listener = std::move(listener);
  }

 private:
  [[nodiscard]] bool lives() const { return computer_.one_runs && computer_.living == number_; }

  Computer& computer_;
  const int number_;
};

class DaemonProcessesTest : public ::testing::Test {
 protected:
  Result<std::unique_ptr<DaemonProcesses>> connect() {
    return DaemonProcesses::connect("rover",
                                    [this]() -> Result<std::unique_ptr<process_server::ProcessService>> {
                                      if (!computer_.one_runs)
                                        return fail(ErrorCode::Unavailable, "none runs");
                                      computer_.living = ++computer_.opened;
                                      return std::make_unique<FakeDaemon>(computer_, computer_.opened);
                                    });
  }
  void start_anew() { computer_.living = 0; }

  Computer computer_;
};

TEST_F(DaemonProcessesTest, ReconnectsToARestartedProcessServer) {
  auto daemon = connect();
  ASSERT_TRUE(daemon);
  int reported = 0;
  (*daemon)->set_listener([&](const process_server::ProcessInfo&) { ++reported; });
  EXPECT_EQ((*daemon)->processes("rover")->size(), 1U);
  start_anew();
  computer_.listener = {};
  EXPECT_EQ((*daemon)->processes("rover")->size(), 2U);
  ASSERT_TRUE(computer_.listener) << "the listener is set at the new process server";
  computer_.listener({});
  EXPECT_EQ(reported, 1);
  EXPECT_TRUE((*daemon)->stop("rover", {}, {}));
  EXPECT_EQ(computer_.opened, 2);
}

TEST_F(DaemonProcessesTest, FailsWhileThereIsNone) {
  auto daemon = connect();
  ASSERT_TRUE(daemon);
  computer_.one_runs = false;
  EXPECT_EQ((*daemon)->stop("rover", {}, {}).error().code, ErrorCode::Unavailable);
  EXPECT_FALSE(connect());
  computer_.one_runs = true;
  start_anew();
  EXPECT_TRUE((*daemon)->stop("rover", {}, {}));
}

TEST_F(DaemonProcessesTest, DoesNotRepeatARefusedCall) {
  auto daemon = connect();
  ASSERT_TRUE(daemon);
  computer_.start_fails = ErrorCode::Unavailable;
  EXPECT_EQ((*daemon)->start({}, {}).error().code, ErrorCode::Unavailable);
  EXPECT_EQ(computer_.calls, 1) << "it is called once";
  EXPECT_EQ(computer_.opened, 1);
}

}  // namespace
}  // namespace segue::runtime
