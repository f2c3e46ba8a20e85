// SPDX-License-Identifier: Apache-2.0
// `segue check` takes every kind of file that another verb reads.
#include <support/paths.hpp>

#include <gmock/gmock.h>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::HasSubstr;

constexpr auto kDomain = R"(; two lamps
(define (domain lamps) (:predicates (on ?l))
  (:action light :parameters (?l) :precondition (not (on ?l)) :effect (on ?l)))
)";
constexpr auto kProblem = "(define (problem two) (:domain lamps) (:objects a b) (:init) (:goal (on a)))\n";

class Check : public SystemTest {
 protected:
  void expect_problem(const std::vector<std::string>& files, const std::string& part) {
    std::vector<std::string> arguments = {"check"};
    arguments.insert(arguments.end(), files.begin(), files.end());
    const auto finished = segue(arguments);
    EXPECT_EQ(finished.status, 1) << finished.output;
    EXPECT_THAT(finished.errors, HasSubstr(part));
  }
};

TEST_F(Check, ATaskNetworkIsChecked) {
  write("tasks.json", R"({"name": "t", "nodes": [{"seq": 0, "name": "a", "duration_s": 1}]})");
  const auto good = segue({"check", "tasks.json"});
  EXPECT_EQ(good.status, 0) << good.errors;
  write("tasks.json", R"({"name": "t", "nodes": [{"seq": 0, "name": "a", "duration_s": "long"}]})");
  expect_problem({"tasks.json"}, "tasks.json:1:");
}

TEST_F(Check, AStandInFileIsChecked) {
  write("stand_ins.yaml", "stand_ins:\n  default: {configure: 10ms}\n");
  const auto good = segue({"check", "stand_ins.yaml"});
  EXPECT_EQ(good.status, 0) << good.errors;
  write("stand_ins.yaml", "stand_ins:\n  default: {configure: often}\n");
  expect_problem({"stand_ins.yaml"}, "stand_ins.yaml:2:");
}

TEST_F(Check, TheFolderOfARafconMachineIsChecked) {
  const std::filesystem::path machines = segue::paths::in_sources("/tests/rafcon");
  const auto good = segue({"check", machines / "side_by_side"});
  EXPECT_EQ(good.status, 0) << good.errors;
  std::filesystem::copy(machines / "side_by_side", folder_ / "machine",
                        std::filesystem::copy_options::recursive);
  write("machine/core_data.json", "{\n  \"name\": oops\n}\n");
  expect_problem({"machine"}, "machine/core_data.json:2:");
}

TEST_F(Check, ScriptsThatAreNoPythonAreFoundWithFileLineAndColumn) {
  write("m.yaml", "mission: m\nactions: {a: {run: {python: a.py}}}\naction: a\n");
  write("a.py", "def execute(self, inputs, outputs, gvm):\n    return 0\n");
  const auto good = segue({"check", "m.yaml"});
  EXPECT_EQ(good.status, 0) << good.errors;
  write("a.py", "def execute(self, inputs, outputs, gvm):\n    return = 0\n");
  expect_problem({"m.yaml"}, "a.py:2:12: error: action 'a': SyntaxError");
}

TEST_F(Check, APlanIsCheckedWithItsDomainAndItsProblem) {
  write("domain.pddl", kDomain);
  write("problem.pddl", kProblem);
  write("plan", "(light a)\n");
  const auto good = segue({"check", "plan", "problem.pddl", "domain.pddl"});
  EXPECT_EQ(good.status, 0) << good.errors;
  expect_problem({"domain.pddl", "plan"}, "name one file of each");
  write("plan", "(light b)\n(light b)\n");
  expect_problem({"domain.pddl", "problem.pddl", "plan"}, "plan:2:");
}

TEST_F(Check, ConfigurationSectionsAreReportedAsNotRead) {
  write("a.cnd", "tasks:\n  a: {type: \"x::Task\", state: RUNNING, config_names: [default]}\n");
  const auto finished = segue({"check", "a.cnd"});
  EXPECT_EQ(finished.status, 0) << finished.errors;
  EXPECT_THAT(finished.errors, HasSubstr("a.cnd:2:"));
  EXPECT_THAT(finished.errors, HasSubstr("sections-not-read"));
}

TEST_F(Check, TheJournalOfARobotIsChecked) {
  start({"--journal", "robot.journal"});
  ASSERT_NE(robot_, nullptr);
  EXPECT_EQ(stop().status, 0);
  const auto good = segue({"check", "robot.journal"});
  EXPECT_EQ(good.status, 0) << good.errors;
  write("other.journal", "SQLite format 3, as it may begin");
  expect_problem({"other.journal"}, "bad-journal");
}

TEST_F(Check, AFolderThatIsNoMachineIsNamed) {
  write("folder/readme", "nothing");
  expect_problem({"folder"}, "is a directory");
}

}  // namespace
}  // namespace segue::testing
