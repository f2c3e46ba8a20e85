// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/file.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission_plan/planned_mission.hpp>

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace segue::mission {

/// Boxes that one hand carries between places.
constexpr std::string_view kCarryDomain = R"((define (domain carry) (:requirements :typing :durative-actions)
  (:types place box)
  (:predicates (at ?p - place) (on ?b - box ?p - place) (hand-empty) (held ?b - box) (arm-free))
  (:action drive :parameters (?from ?to - place)
    :precondition (at ?from) :effect (and (not (at ?from)) (at ?to)))
  (:action take :parameters (?b - box ?p - place)
    :precondition (and (at ?p) (on ?b ?p) (hand-empty))
    :effect (and (held ?b) (not (on ?b ?p)) (not (hand-empty))))
  (:durative-action put :parameters (?b - box ?p - place) :duration (= ?duration 2)
    :condition (and (over all (at ?p)) (at start (held ?b)) (at start (arm-free)))
    :effect (and (at start (not (arm-free))) (at end (arm-free)) (at end (on ?b ?p)) (at end (not (held ?b)))
                 (at end (hand-empty))))))";
constexpr std::string_view kCarryProblem = R"((define (problem tidy.up) (:domain carry)
  (:objects dock table - place red - box)
  (:init (at dock) (on red table) (hand-empty) (arm-free)) (:goal (on red dock))))";
constexpr std::string_view kCarryLibrary = R"yaml(mission: hands
observe: {"at(dock)": {task: seeker, state: arrived}}
resources: {arm: {class: module}}
actions:
  go: {inputs: {place: map, speed: {type: float, default: 1.0}}, outcomes: [there, blocked], run: {simulated: {duration: 3s}}}
  grip: {inputs: {box: int}, resources: [{block: arm}], run: {simulated: {duration: 1s}}}
  think: {run: {python: think.py}}
action: think
)yaml";
constexpr std::string_view kCarryMapping = R"yaml(plan_mapping: carry
domain: carry.pddl
library: hands.yaml
objects:
  place: {dock: {x: 0.0, y: 0.0}, table: {x: 2.0, y: 1.0}}
  box: {red: 7}
facts:
  hand-empty: "!full()"
  held: "holding(hand, {b})"
actions:
  drive: {action: go, inputs: {place: "{to}"}, outcome: there}
  take: {action: grip, inputs: {box: "{b}"}}
  put: {run: {controller: arm, call: {arm.put: {box: "{b}", where: {pose: "{p}"}}}, until: [{after: 1min}]}}
)yaml";
constexpr std::string_view kCarryPlan =
    "0: (drive dock table)\n1: (take red table)\n2: (drive table dock)\n3: (put red dock) [2]\n";

inline std::string text_with(std::string_view text, std::string_view old, std::string_view with) {
  std::string result(text);
  const auto at = result.find(old);
  EXPECT_NE(at, std::string::npos) << old;
  return at == std::string::npos ? result : result.replace(at, old.size(), with);
}

/// A folder with the files above.
class CarryFiles : public testing::Test {
 protected:
  CarryFiles() {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    write("carry.pddl", kCarryDomain);
    write("problem.pddl", kCarryProblem);
    write("hands.yaml", kCarryLibrary);
    write("mapping.yaml", kCarryMapping);
    write("think.py", "def execute(self, inputs, outputs, gvm):\n    return 0\n");
    write("plan", kCarryPlan);
  }
  ~CarryFiles() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, std::string_view text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  /// The diagnostics without the folder, one a line.
  [[nodiscard]] std::string told(const Diagnostics& diagnostics) const {
    std::string text = to_string(diagnostics);
    const std::string folder = folder_.string() + "/";
    for (auto at = text.find(folder); at != std::string::npos; at = text.find(folder))
      text.erase(at, folder.size());
    if (text.ends_with('\n')) text.pop_back();
    return text;
  }

  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string("carry_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

}  // namespace segue::mission
