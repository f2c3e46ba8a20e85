// SPDX-License-Identifier: Apache-2.0
#include "ros2_look.hpp"

#include <gtest/gtest.h>
#include <support/eventually.hpp>
#include <support/temporary_files.hpp>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <stop_token>
#include <string>
#include <thread>

namespace segue::cli {
namespace {

using segue::testing::eventually;
using type::Value;

/// A shell script in place of the program that looks.
struct Ros2Look : ::testing::Test {
  segue::testing::TemporaryFiles files;

  Ros2SystemOptions with(const std::string& script) {
    Ros2SystemOptions options;
    options.program = files.folder() / "look";
    std::ofstream(options.program) << "#!/bin/sh\n" << script << '\n';
    std::filesystem::permissions(options.program, std::filesystem::perms::owner_all);
    return options;
  }
  /// As the script has written it; 0: not yet.
  pid_t pid() {
    std::ifstream file(files.folder() / "pid");
    pid_t number = 0;
    return file >> number && file.get() == '\n' ? number : 0;
  }
  /// Ends neither by the end of its input nor by itself.
  std::string stubborn() const {
    return "cd " + files.folder().string() + "; echo $$ > pid; exec sleep 1000";
  }
  void expect_killed() { EXPECT_EQ(::kill(pid(), 0), -1) << "it has been waited for, too"; }
};

TEST_F(Ros2Look, AsksTheProgramAndAnswersWhatItTells) {
  Ros2SystemOptions options = with(R"(printf '{"asked": %s}' "$1")");
  options.domain = 7;
  options.discovery = "localhost";
  const auto seen = look_at_ros2(options, Value::map({{"all", true}}));
  ASSERT_TRUE(seen) << to_string(seen.error());
  EXPECT_EQ(
      *seen->find("asked"),
      Value::map(
          {{"all", true}, {"domain", 7}, {"discovery", "localhost"}, {"wait", "3s"}, {"patience", "5s"}}));
}

TEST_F(Ros2Look, HasTheErrorOfTheProgram) {
  const auto seen =
      look_at_ros2(with(R"(echo '{"error": {"code": "not-found", "message": "no node"}}')"), Value::map({}));
  ASSERT_FALSE(seen);
  EXPECT_EQ(seen.error().code, ErrorCode::NotFound);
  EXPECT_EQ(seen.error().message, "no node");
  EXPECT_EQ(look_at_ros2(with("exit 1"), Value::map({})).error().code, ErrorCode::Internal);
}

TEST_F(Ros2Look, EndsTheProgramWhenItsTimeIsOver) {
  // Its end is told apart from that of a program that has not begun.
  const std::string script = stubborn();
  const Ros2SystemOptions options = with(script);
  Result<Value> seen = Value();
  Duration time = std::chrono::milliseconds(50);
  do {
    seen = look_at_ros2(options, Value::map({}), Wait(monotonic_now() + time));
    time *= 2;
  } while (pid() == 0 && time < segue::testing::kPatience);
  ASSERT_FALSE(seen);
  EXPECT_EQ(seen.error().code, ErrorCode::DeadlineExceeded);
  expect_killed();
}

TEST_F(Ros2Look, EndsTheProgramWhenNobodyWantsItsResult) {
  std::stop_source stop;
  std::jthread asker([&] {
    EXPECT_TRUE(eventually([&] { return pid() != 0; }));
    stop.request_stop();
  });
  const auto seen =
      look_at_ros2(with(stubborn()), Value::map({}), Wait(segue::testing::kPatience, stop.get_token()));
  asker.join();
  ASSERT_FALSE(seen);
  EXPECT_EQ(seen.error().code, ErrorCode::Cancelled);
  expect_killed();
}

TEST_F(Ros2Look, EndsAProgramThatTellsTooMuch) {
  Ros2SystemOptions options = with("cd " + files.folder().string() + "; echo $$ > pid; exec yes");
  options.most_output = std::size_t{1} << 20;
  const auto seen = look_at_ros2(options, Value::map({}));
  ASSERT_FALSE(seen);
  EXPECT_EQ(seen.error().code, ErrorCode::ResourceExhausted);
  EXPECT_EQ(seen.error().message, "the nodes of ROS 2 tell more than the 1 MiB that are taken");
  expect_killed();
}

}  // namespace
}  // namespace segue::cli
