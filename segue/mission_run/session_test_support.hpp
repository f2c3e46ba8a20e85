// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/file.hpp>
#include <segue/mission_run/session.hpp>

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include <unistd.h>

namespace segue::mission_run {

/// Warming up takes four seconds and looking three; only the grasp needs both.
inline constexpr const char* kGrasp = R"j(mission: m
actions:
  warm_up: {effects: ["+warm()"], run: {simulated: {duration: 4s}}}
  look: {pure: true, outputs: {pose: int}, run: {simulated: {duration: 3s, outputs: {pose: 7}}}}
  grasp: {inputs: {pose: int}, preconditions: ["warm()"], run: {callback: grasp}}
start: warm_up
inputs: {force: {type: int, default: 1}}
outputs: {pose: int}
flows: [look.pose -> grasp.pose, look.pose -> outputs.pose]
states:
  warm_up: {on: {success: look}}
  look: {on: {success: grasp}}
  grasp: {on: {success: return success}}
)j";

class Sessions : public ::testing::Test {
 protected:
  Sessions()
      : folder_(std::filesystem::temp_directory_path() / ("session_test." + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~Sessions() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    EXPECT_TRUE(write_file((folder_ / name).string(), text));
    return folder_ / name;
  }
  Session load(const std::string& name, const std::string& text) const {
    Diagnostics diagnostics;
    auto session = Session::load(write(name, text), {}, diagnostics);
    EXPECT_TRUE(session) << to_string(diagnostics);
    return *session;
  }
  /// In virtual time, with a grasp that succeeds at once.
  static RunRequest request(RunMode mode) {
    RunRequest request;
    request.mode = mode;
    request.clock = task_network::ClockKind::Virtual;
    request.runners.add("grasp", [](mission::ActionCall&) { return mission::Ending{}; });
    return request;
  }

  const std::filesystem::path folder_;
};

}  // namespace segue::mission_run
