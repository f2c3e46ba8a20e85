// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/json.hpp>
#include <segue/type/value.hpp>

#include <support/eventually.hpp>
#include <support/paths.hpp>

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "../fault/processes.hpp"
#include "../support/sanitizer_reports.hpp"
#include "process.hpp"

namespace segue::testing {

/// A folder for each test, with folders for sockets and journals; `segue` is the real program.
class SystemTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = ::testing::TempDir() + "segue-system-XXXXXX";
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    std::filesystem::create_directory(folder_ / "runtime");
    ::setenv("XDG_RUNTIME_DIR", (folder_ / "runtime").c_str(), 1);
    ::setenv("XDG_STATE_HOME", (folder_ / "state").c_str(), 1);
    ::unsetenv("SEGUE_LIBRARY_PATH");
    collect_sanitizer_reports(folder_);
  }
  void TearDown() override {
    robot_.reset();
    for (const auto& [pid, program] : processes_of(folder_ / "runtime"))
      ::kill(pid, SIGKILL);  // processes of robots outlive their runtime
    EXPECT_EQ(sanitizer_reports(folder_), "");
    std::filesystem::remove_all(folder_);
  }

  static std::vector<std::string> command(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), segue::paths::kProgram);
    return arguments;
  }
  Finished segue(std::vector<std::string> arguments) { return run(command(std::move(arguments)), folder_); }

  /// Runs with `--format json`; the output must be JSON.
  type::Value json(std::vector<std::string> arguments, int status = 0) {
    arguments.insert(arguments.end(), {"--format", "json"});
    const auto finished = segue(arguments);
    EXPECT_EQ(finished.status, status) << finished.errors;
    const auto value = type::parse_json(finished.output);
    EXPECT_TRUE(value) << finished.output << finished.errors;
    return value.value_or(type::Value());
  }

  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }

  /// `segue init rover`, and `segue run` until it is ready.
  void start(std::vector<std::string> more = {}) {
    if (!std::filesystem::exists(folder_ / "rover")) {
      ASSERT_EQ(segue({"init", "rover"}).status, 0);
    }
    std::vector<std::string> arguments = {"run", "rover/robot.yaml"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    robot_ = std::make_unique<Process>(command(std::move(arguments)), folder_);
    if (!robot_->wait_for("robot rover runs")) {
      const auto finished = robot_->wait();
      FAIL() << finished.output << finished.errors;
    }
  }
  /// The name of what the robot runs.
  [[nodiscard]] std::string controller() { return json({"status"}).find("controller")->as_string(); }
  void wait_for_controller(const std::string& name) {
    ASSERT_TRUE(eventually([&] { return controller() == name; })) << "the robot does not run " << name;
  }
  /// Shuts the robot down cleanly.
  Finished stop(int signal = SIGINT) {
    robot_->signal(signal);
    const auto finished = robot_->wait();
    robot_.reset();
    return finished;
  }

  std::filesystem::path folder_;
  std::unique_ptr<Process> robot_;
};

}  // namespace segue::testing
