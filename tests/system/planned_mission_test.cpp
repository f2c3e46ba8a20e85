// SPDX-License-Identifier: Apache-2.0
// Plans of planners, by a mapping, as missions of a running robot.
#include <gmock/gmock.h>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::HasSubstr;

constexpr const char* kDomain = R"((define (domain visits) (:requirements :typing)
  (:types place)
  (:predicates (at ?p - place) (seen ?p - place) (docked))
  (:action go :parameters (?from ?to - place)
    :precondition (at ?from) :effect (and (at ?to) (not (at ?from))))
  (:action look :parameters (?p - place) :precondition (at ?p) :effect (seen ?p))
  (:action dock :parameters (?p - place) :precondition (at ?p) :effect (docked)))
)";
constexpr const char* kProblem = R"((define (problem visit) (:domain visits) (:objects home near - place)
  (:init (at home)) (:goal (and (seen near) (at home)))))";
constexpr const char* kMapping = R"(plan_mapping: visits
domain: visits.pddl
objects:
  place: {home: {x: 0.0, y: 0.0}, near: {x: 0.3, y: 0.0}}
observe:
  docked: {task: seeker, state: arrived, settle: 30s}
actions:
  go:
    run:
      controller: go_to
      call: {seeker.set_goal: {goal: "{to}"}}
      until: [{task: seeker, state: arrived}, {after: 5min, outcome: aborted}]
  look: {run: {simulated: {duration: 1ms}}}
  dock: {run: {controller: go_to}}
)";

class PlannedMissions : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    write("visits.pddl", kDomain);
    write("problem.pddl", kProblem);
    write("mapping.yaml", kMapping);
  }
};

TEST_F(PlannedMissions, RunOnTheRobotWhateverThePlannersFormat) {
  start();
  for (const char* plan :
       {"(go home near)\n(look near)\n(go near home)\n; cost = 3 (unit cost)\n",
        "0.000: (go home near) [1.000]\n1.001: (look near) [1.000]\n2.002: (go near home) [1.000]\n",
        "ff: found legal plan as follows\n\nstep    0: GO HOME NEAR\n        1: LOOK NEAR\n"
        "        2: GO NEAR HOME\n\n"}) {
    write("plan", plan);
    const auto planned =
        segue({"mission", "plan", "mapping.yaml", "problem.pddl", "--plan", "plan", "-o", "visit.yaml"});
    ASSERT_EQ(planned.status, 0) << planned.errors;
    const auto ran = json({"mission", "run", "visit.yaml", "--no-progress"});
    EXPECT_EQ(ran.find("outcome")->as_string(), "done");
    EXPECT_EQ(ran.find("nodes")->as_list().size(), 3U);
  }
  EXPECT_EQ(controller(), "go_to");
}

TEST_F(PlannedMissions, AreRefusedForPlansThatDoNotReachTheGoal) {
  write("plan", "(go home near)\n(look near)\n");
  const auto refused = segue({"mission", "plan", "mapping.yaml", "problem.pddl", "--plan", "plan"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.errors,
              HasSubstr("plan:2:1: error: the plan does not reach the goal at(home) [goal-missed]"));
  EXPECT_EQ(refused.output, "");
}

/// The errors where the planner is this script of the shell.
class OwnPlanner : public PlannedMissions {
 protected:
  Finished planned_by(const std::string& script) {
    write("planner.sh", "#!/bin/sh\n" + script + "\n");
    std::filesystem::permissions(folder_ / "planner.sh", std::filesystem::perms::owner_all);
    write("robot.yaml",
          "robot: r\nplanner: {command: [./planner.sh, \"{domain}\", \"{problem}\"], timeout: 1s}\n");
    return segue({"mission", "plan", "mapping.yaml", "problem.pddl", "--robot-file", "robot.yaml"});
  }
  void expect_failure(const std::string& script, const std::string& error) {
    const auto failed = planned_by(script);
    EXPECT_EQ(failed.status, 1) << script;
    EXPECT_THAT(failed.errors, HasSubstr(error)) << script;
    EXPECT_EQ(failed.output, "") << script;
  }
};

TEST_F(OwnPlanner, IsGivenDomainAndProblem) {
  const auto planned = planned_by(
      "grep -q 'domain visits' $1 && grep -q 'problem visit' $2 && echo '(go home near)' &&"
      " echo '(look near)' && echo '(go near home)'");
  EXPECT_EQ(planned.status, 0) << planned.errors;
  EXPECT_THAT(planned.output, HasSubstr("look_near"));
}

TEST_F(OwnPlanner, IsReportedTrulyWhereItHasNoPlan) {
  expect_failure("echo searching; sleep 1000", "the planner found no plan within 1s");
  expect_failure("kill -KILL $$", "signal 9 (Killed) ended the planner");
  expect_failure("exit 0", "the planner ended with status 0 and printed no plan");
  expect_failure("echo no solution >&2; exit 12",
                 "the planner ended with status 12; the last that it wrote: 'no solution'");
  expect_failure("echo Welcome to the planner", ":1:1: error: this is not a step of a plan");
  expect_failure("echo '(go near home)'", ":1:1: error: at(near) does not hold before this step");
  expect_failure("echo '(go home near)'", ":1:1: error: the plan does not reach the goal");
}

TEST_F(PlannedMissions, ArePlannedByTheBuiltInPlanner) {
  const auto planned = segue({"mission", "plan", "mapping.yaml", "problem.pddl", "-o", "visit.yaml"});
  ASSERT_EQ(planned.status, 0) << planned.errors;
  EXPECT_EQ(segue({"mission", "run", "visit.yaml", "--simulate", "--clock", "virtual"}).status, 0);
  write("problem.pddl",
        "(define (problem none) (:domain visits) (:objects home near - place) (:init) (:goal (docked)))");
  const auto refused = segue({"mission", "plan", "mapping.yaml", "problem.pddl"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.errors, HasSubstr("the problem has no plan"));
}

TEST_F(PlannedMissions, BeginWithWhatTheRobotShows) {
  write("problem.pddl",
        "(define (problem docking) (:domain visits) (:objects home near - place) (:init (at home)) (:goal "
        "(docked)))");
  const std::vector<std::string> plan = {"mission",   "plan", "mapping.yaml", "problem.pddl",
                                         "--observe", "-o",   "dock.yaml"};
  start();
  const auto unknown = segue(plan);
  EXPECT_THAT(unknown.errors, HasSubstr("docked() cannot be observed now: what is known of it counts"));
  const auto docking = json({"mission", "run", "dock.yaml", "--simulate", "--clock", "virtual"});
  EXPECT_EQ(docking.find("nodes")->as_list().size(), 1U);
  ASSERT_EQ(segue({"switch", "go_to"}).status, 0);
  ASSERT_EQ(segue({"call", "seeker.set_goal", "goal={x: 0.0, y: 0.0}"}).status, 0);
  ASSERT_TRUE(segue::testing::eventually([&] {
    return json({"task", "seeker"}).find("state_name")->as_string() == "arrived";
  }));
  ASSERT_EQ(segue(plan).status, 0);
  const auto docked = json({"mission", "run", "dock.yaml", "--simulate", "--clock", "virtual"});
  EXPECT_EQ(docked.find("nodes")->as_list().size(), 0U) << "the goal holds already";
}

TEST_F(PlannedMissions, HaveMappingsThatAreChecked) {
  EXPECT_EQ(segue({"check", "mapping.yaml"}).status, 0);
  write("mapping.yaml", "plan_mapping: visits\ndomain: visits.pddl\nactions: {fly: {action: go}}\n");
  const auto refused = segue({"check", "mapping.yaml"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.errors,
              HasSubstr("mapping.yaml:3:16: error: the domain has no action 'fly' [unknown-action]"));
}

}  // namespace
}  // namespace segue::testing
