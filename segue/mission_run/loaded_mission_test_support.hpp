// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/file.hpp>
#include <segue/mission_run/both_modes.hpp>
#include <segue/mission_run/loaded_mission.hpp>

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <utility>

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

class LoadedMissions : public ::testing::Test {
 protected:
  LoadedMissions()
      : folder_(std::filesystem::temp_directory_path() /
                ("loaded_mission_test." + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~LoadedMissions() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    EXPECT_TRUE(write_file((folder_ / name).string(), text));
    return folder_ / name;
  }
  LoadedMission load(const std::string& name, const std::string& text) const {
    auto plan = LoadedMission::load(write(name, text));
    EXPECT_TRUE(plan) << to_string(diagnostics_of(plan.error()));
    return *plan;
  }
  /// In virtual time, with a grasp that succeeds at once.
  static RunRequest request(RunMode mode) {
    RunRequest request;
    request.mode = std::move(mode);
    request.clock = RunClock::Virtual;
    request.runners.add("grasp", [](mission::ActionCall&) { return mission::Ending{}; });
    return request;
  }

  const std::filesystem::path folder_;
};

}  // namespace segue::mission_run
