// SPDX-License-Identifier: Apache-2.0
#include <segue/pddl/pddl.hpp>
#include <segue/task_network/concurrent_engine.hpp>
#include <segue/task_network/order.hpp>
#include <segue/task_network/simulated_environment.hpp>

#include <gmock/gmock.h>

namespace segue::pddl {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Rovers drive and dig; both rovers share one drill, which a step holds from its start to its end.
constexpr std::string_view kRovers = R"(
(define (domain rovers) (:requirements :durative-actions :typing)
  (:types vehicle place - object rover truck - vehicle)
  (:predicates (at ?v - vehicle ?p - place) (drill-free) (moving ?v - vehicle) (dug ?p - place) (open ?p - place))
  (:functions (distance ?a ?b - place) (speed))
  (:durative-action drive :parameters (?v - vehicle ?from ?to - place)
    :duration (= ?duration (/ (distance ?from ?to) (speed)))
    :condition (and (at start (at ?v ?from)) (over all (moving ?v)) (at end (open ?to)))
    :effect (and (at start (not (at ?v ?from))) (at start (moving ?v)) (at end (at ?v ?to))
                 (at end (not (moving ?v)))))
  (:durative-action dig :parameters (?r - rover ?p - place)
    :duration (and (>= ?duration 2) (<= ?duration 4))
    :condition (and (at start (drill-free)) (over all (at ?r ?p)))
    :effect (and (at start (not (drill-free))) (at end (drill-free)) (at end (dug ?p))))
  (:action wave :parameters (?v - vehicle) :precondition () :effect ())))";
constexpr std::string_view kTwoPlaces = R"(
(define (problem both) (:domain rovers) (:objects r s - rover t - truck home left right - place)
  (:init (at r home) (at s home) (at t home) (drill-free) (open left) (open right) (= (speed) 2)
         (= (distance home left) 10) (= (distance home right) 6))
  (:goal (and (dug left) (dug right))) (:metric minimize (total-time))))";

struct ReadPlan {
  std::optional<PddlPlan> plan;
  std::string problems;
};

ReadPlan read_rovers(std::string_view plan, std::string_view domain = kRovers) {
  Diagnostics diagnostics;
  ReadPlan result;
  result.plan = read_pddl({domain, "domain"}, {kTwoPlaces, "problem"}, {plan, "plan"}, diagnostics);
  result.problems = to_string(diagnostics);
  if (result.problems.ends_with('\n')) result.problems.pop_back();
  return result;
}

constexpr std::string_view kBoth =
    "0.000: (drive r home left) [5.000]\n0.000: (drive s home right) [3.000]\n"
    "3.001: (dig s right) [4.000]\n7.002: (dig r left) [2.000]\n";

std::string replaced(std::string_view text, std::string_view old, std::string_view with) {
  std::string result(text);
  const auto at = result.find(old);
  EXPECT_NE(at, std::string::npos) << old;
  return result.replace(at, old.size(), with);
}

TEST(DurativeActions, TakeTheTimeThatThePlanSays) {
  auto [plan, problems] = read_rovers(kBoth);
  ASSERT_TRUE(plan) << problems;
  std::vector<double> seconds;
  for (std::uint32_t i = 0; i < plan->network.size(); ++i)
    seconds.push_back(std::chrono::duration<double>(plan->network[task_network::NodeId{i}].duration).count());
  EXPECT_THAT(seconds, ElementsAre(5, 3, 4, 2));
}

TEST(DurativeActions, HoldFactsThatTheyChangeMeanwhile) {
  auto [plan, problems] = read_rovers(kBoth);
  ASSERT_TRUE(plan) << problems;
  const auto order = task_network::derive_order(plan->network);
  task_network::SimulatedEnvironment environment(plan->network);
  const auto run = task_network::ConcurrentEngine(plan->network, order, environment).run();
  ASSERT_TRUE(run.done());
  EXPECT_EQ(run.makespan, std::chrono::seconds(9))
      << "one drives while the other does, but one digs at a time";
}

TEST(DurativeActions, TellWhatMustHoldAllAlong) {
  auto [plan, problems] = read_rovers(kBoth);
  ASSERT_TRUE(plan) << problems;
  const PlannedStep& dig = plan->steps[2];
  EXPECT_EQ(dig.action, "dig");
  EXPECT_THAT(dig.objects, ElementsAre("s", "right"));
  ASSERT_EQ(dig.during.size(), 1U);
  EXPECT_EQ(plan->network.facts.text(dig.during[0]), "at(s,right)");
  ASSERT_EQ(dig.meanwhile.size(), 1U);
  EXPECT_EQ(plan->network.facts.text(dig.meanwhile[0]), "drill-free()");
}

TEST(DurativeActions, TakeTheTimeOfTheDomainWhereThePlanSaysNone) {
  const auto [plan, problems] =
      read_rovers("(drive r home left)\n(drive s home right)\n(dig s right)\n(dig r left)");
  EXPECT_EQ(problems,
            "plan:3:1: error: the plan does not say how long this step takes, such as [1.5] [bad-duration]\n"
            "plan:4:1: error: the plan does not say how long this step takes, such as [1.5] [bad-duration]");
  EXPECT_FALSE(plan);
}

TEST(DurativeActions, AreRefusedForATimeThatTheyDoNotTake) {
  EXPECT_THAT(read_rovers(replaced(kBoth, "[5.000]", "[6.0]")).problems,
              HasSubstr("plan:1:8: error: the action does not take 6.000000 s [bad-duration]"));
  EXPECT_EQ(read_rovers(replaced(kBoth, "[5.000]", "[5.0009]")).problems, "");
  EXPECT_THAT(read_rovers(replaced(kBoth, "[5.000]", "[long]")).problems,
              HasSubstr("plan:1:28: error: a duration is a number of seconds, such as [1.5] [bad-plan]"));
}

TEST(DurativeActions, MustHaveTheirConditionsOneAfterTheOther) {
  EXPECT_THAT(read_rovers(replaced(kBoth, "(dig s right)", "(dig s left)")).problems,
              HasSubstr("plan:3:8: error: at(s,left) does not hold before this step [false-precondition]"));
  const std::string closed = replaced(kRovers, "(at end (open ?to))", "(at end (dug ?to))");
  EXPECT_THAT(read_rovers(kBoth, closed).problems, HasSubstr("plan:1:8: error: dug(left) does not hold"));
  const std::string undone = replaced(kRovers, "(over all (moving ?v))", "(over all (at ?v ?from))");
  EXPECT_THAT(read_rovers(kBoth, undone).problems,
              HasSubstr("plan:1:8: error: the step itself undoes at(r,home) [false-precondition]"));
}

TEST(DurativeActions, TakeObjectsOfSubtypesOnly) {
  EXPECT_EQ(read_rovers("0: (drive t home left) [5]\n" + std::string(kBoth)).problems, "");
  EXPECT_THAT(read_rovers(std::string(kBoth) + "9: (dig t left) [2]\n").problems,
              HasSubstr("plan:5:9: error: 't' is not an object of type rover [bad-step]"));
}

TEST(DurativeActions, AreRefusedWithFileAndLineWhereTheyAreWrong) {
  const auto told = [](std::string_view old, std::string_view with) {
    return read_rovers(kBoth, replaced(kRovers, old, with)).problems;
  };
  EXPECT_EQ(
      told("(over all (moving ?v))", "(moving ?v)"),
      "domain:8:46: error: a condition of a durative action is (at start ...), (over all ...) or (at end "
      "...) [bad-time]");
  EXPECT_EQ(
      told("(at end (dug ?p))", "(dug ?p)"),
      "domain:14:70: error: an effect of a durative action is (at start ...) or (at end ...) [bad-time]");
  EXPECT_EQ(told("(at end (dug ?p))", "(at end (when (open ?p) (dug ?p)))"),
            "domain:14:70: error: 'when' in a durative action is not supported [unsupported]");
  EXPECT_EQ(told("(at start (drill-free)) (over", "(at start (>= (speed) 1)) (over"),
            "domain:13:31: error: a numeric condition is not supported [unsupported]");
  EXPECT_EQ(told("    :duration (and (>= ?duration 2) (<= ?duration 4))\n", ""),
            "domain:11:3: error: a durative action needs a ':duration' such as (= ?duration 5) [bad-action]");
  EXPECT_THAT(told("(= ?duration (/", "(= 5 (/"), HasSubstr("domain:7:15: error: a duration is such as"));
  EXPECT_THAT(told("(/ (distance ?from ?to) (speed))", "(- 0 (speed))"),
              HasSubstr("a duration is at least 0 s and not infinite"));
  EXPECT_THAT(told("(/ (distance ?from ?to) (speed))", "(distance ?to ?from)"),
              HasSubstr("domain:7:28: error: the problem gives (distance left home) no value [no-value]"));
  EXPECT_THAT(told("(at end (dug ?p))", "(at end (dug ?p)) (at end (decrease (speed) 1))"),
              HasSubstr("a duration by a function that actions change, 'speed', is not supported"));
}

}  // namespace
}  // namespace segue::pddl
