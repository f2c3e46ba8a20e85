// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/runtime/test_support.hpp>

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <utility>
#include <vector>

/// A robot of stand-ins that says what rest is. For tests.
namespace segue::runtime::testing {

inline constexpr const char* kDrive =
    "network: drive\n"
    "tasks:\n"
    "  wheels: {component: \"x::Wheels\", exclusive: [wheels], activity: {periodic: 1ms}}\n"
    "  planner: {component: \"x::Planner\"}\n"
    "  button: {component: \"x::Button\"}\n"
    "connections: [planner.out -> wheels.command]\n";
inline constexpr const char* kWork =
    "network: work\n"
    "tasks:\n"
    "  wheels: {component: \"x::Wheels\", exclusive: [wheels], activity: {periodic: 1ms}}\n"
    "  tool: {component: \"x::Tool\", properties: {speed: 2}}\n"
    "  button: {component: \"x::Button\"}\n"
    "connections: [tool.out -> wheels.command]\n";
inline constexpr const char* kHold =
    "network: hold\n"
    "tasks:\n"
    "  wheels: {component: \"x::Wheels\", exclusive: [wheels], activity: {periodic: 1ms}}\n"
    "  brake: {component: \"x::Brake\"}\n"
    "  button: {component: \"x::Button\"}\n"
    "connections: [brake.out -> wheels.command]\n";

inline model::Halt hold(std::vector<model::HaltCondition> at_rest = {
                            {model::TaskReaches{"wheels", "running"}, {}}}) {
  model::Halt halt;
  halt.controller = model::NetworkName("hold");
  halt.at_rest = std::move(at_rest);
  halt.within = std::chrono::seconds(60);
  return halt;
}

inline RuntimeOptions with(model::Halt halt) {
  RuntimeOptions options;
  options.halt = std::move(halt);
  return options;
}

/// Runs "drive".
struct HaltingRobot : StandInRobot {
  explicit HaltingRobot(RuntimeOptions options = with(hold())) : StandInRobot(std::move(options)) {
    for (const char* text : {kDrive, kWork, kHold})
      EXPECT_FALSE(runtime.add_controller(network_of(text)).has_errors());
    EXPECT_EQ(switch_to("drive").outcome, Outcome::Done);
  }
  SwitchResult switch_to(const char* name, RequestOptions options = {}) {
    return runtime.switch_to(model::NetworkName(name), std::move(options));
  }
  std::string running() { return runtime.belief().name.str(); }
};

}  // namespace segue::runtime::testing
