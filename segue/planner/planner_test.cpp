// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/planner/planner.hpp>

#include <support/shared_data.hpp>

#include <gmock/gmock.h>

namespace segue::planner {
namespace {

using ::testing::HasSubstr;

/// The plan, or the error; a plan is checked by the reader of plans.
std::string planned(std::string_view domain, std::string_view problem, const PlannerOptions& options = {}) {
  const auto plan = find_plan({domain, "domain"}, {problem, "problem"}, options);
  if (!plan) return std::string(to_string(plan.error().code)) + ": " + to_string(plan.error());
  Diagnostics diagnostics;
  const auto read =
      pddl::read_pddl({domain, "domain"}, {problem, "problem"}, {plan->text, "plan"}, diagnostics);
  EXPECT_TRUE(read) << to_string(diagnostics) << plan->text;
  return plan->text;
}

constexpr std::string_view kStack =
    R"((define (domain stack) (:requirements :strips :equality :negative-preconditions)
  (:predicates (clear ?x) (on ?x ?y) (held ?x) (fixed ?x))
  (:action take :parameters (?x ?y)
    :precondition (and (clear ?x) (on ?x ?y) (not (held ?y)) (not (fixed ?x)))
    :effect (and (held ?x) (clear ?y) (not (on ?x ?y)) (not (clear ?x))))
  (:action put :parameters (?x ?y)
    :precondition (and (held ?x) (clear ?y) (not (= ?x ?y)))
    :effect (and (on ?x ?y) (clear ?x) (not (held ?x)) (not (clear ?y))))))";

TEST(Planner, FindsAPlanThatReachesTheGoal) {
  EXPECT_EQ(planned(kStack,
                    "(define (problem p) (:domain stack) (:objects a t u) (:init (on a t) (clear a) (clear u)"
                    " (fixed t) (fixed u)) (:goal (on a u)))"),
            "(take a t)\n(put a u)\n; cost = 2 (unit cost)\n");
}

TEST(Planner, KeepsToNegativePreconditionsAndGoals) {
  EXPECT_THAT(
      planned(kStack,
              "(define (problem p) (:domain stack) (:objects a t u) (:init (on a t) (clear a) (clear u)"
              " (fixed a)) (:goal (on a u)))"),
      HasSubstr("not-found: the problem has no plan"));
  EXPECT_EQ(planned(kStack,
                    "(define (problem p) (:domain stack) (:objects a t u) (:init (on a t) (clear a) (clear u)"
                    " (fixed t) (fixed u)) (:goal (not (on a t))))"),
            "(take a t)\n; cost = 1 (unit cost)\n");
  EXPECT_EQ(
      planned(kStack, "(define (problem p) (:domain stack) (:objects a) (:init) (:goal (not (clear a))))"),
      "; cost = 0 (unit cost)\n");
}

constexpr std::string_view kWays = R"((define (domain ways) (:requirements :typing :action-costs)
  (:types vehicle place - object car - vehicle)
  (:predicates (at ?v - vehicle ?p - place) (way ?a ?b - place))
  (:functions (total-cost) (toll ?a ?b - place))
  (:action go :parameters (?v - vehicle ?a ?b - place) :precondition (and (at ?v ?a) (way ?a ?b))
    :effect (and (at ?v ?b) (not (at ?v ?a)) (increase (total-cost) (toll ?a ?b))))
  (:action park :parameters (?c - car ?p - place) :precondition (at ?c ?p) :effect (increase (total-cost) 0.5))))";
constexpr std::string_view kDetour =
    R"((define (problem detour) (:domain ways) (:objects c - car a b d - place)
  (:init (at c a) (way a d) (way a b) (way b d) (= (total-cost) 0)
         (= (toll a d) 90) (= (toll a b) 1) (= (toll b d) 1.5))
  (:goal (at c d)) (:metric minimize (total-cost))))";

TEST(Planner, PrefersWhatCostsLess) {
  EXPECT_EQ(planned(kWays, kDetour), "(go c a b)\n(go c b d)\n; cost = 2.5 (general cost)\n");
}

TEST(Planner, TakesDurativeActionsOneAfterTheOther) {
  constexpr std::string_view domain = R"((define (domain dig) (:types place)
    (:predicates (at ?p - place) (free) (busy) (dug ?p - place))
    (:durative-action go :parameters (?a ?b - place) :duration (= ?duration 2)
      :condition (and (at start (at ?a)) (over all (busy)))
      :effect (and (at start (not (at ?a))) (at start (busy)) (at end (not (busy))) (at end (at ?b))))
    (:durative-action dig :parameters (?p - place) :duration (= ?duration 1)
      :condition (and (at start (free)) (over all (at ?p)))
      :effect (and (at start (not (free))) (at end (free)) (at end (dug ?p))))))";
  EXPECT_EQ(planned(domain,
                    "(define (problem p) (:domain dig) (:objects a b - place) (:init (at a) (free))"
                    " (:goal (and (dug a) (dug b))))"),
            "(dig a)\n(go a b)\n(dig b)\n; cost = 3 (unit cost)\n");
}

TEST(Planner, SaysWhyItHasNoPlan) {
  EXPECT_THAT(planned(kWays,
                      "(define (problem p) (:domain ways) (:objects c - car a d - place) (:init (at c a))"
                      " (:goal (at c d)))"),
              HasSubstr("not-found: the problem has no plan"));
  EXPECT_THAT(planned(kWays, "(define (problem p) (:domain ways) (:init (at c a)) (:goal ()))"),
              HasSubstr("invalid-argument: problem:1:43: "));
  EXPECT_THAT(planned("(define (domain d) (:predicates (p)) (:action a :effect (when (p) (not (p)))))",
                      "(define (problem x) (:domain d) (:init (p)) (:goal (not (p))))"),
              HasSubstr("domain:1:57: the built-in planner does not support 'when' in effects"));
  EXPECT_THAT(planned("(define (domain d) (:predicates (p ?x)) (:action a :effect (p b)))",
                      "(define (problem x) (:domain d) (:objects a) (:init) (:goal (p a)))"),
              HasSubstr("domain:1:63: there is no object 'b'"));
}

TEST(Planner, EndsWhereItMustNotGoOn) {
  PlannerOptions late;
  late.deadline = monotonic_now();
  EXPECT_THAT(planned(kWays, kDetour, late), HasSubstr("deadline-exceeded: no plan was found in time"));
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THAT(
      planned(kWays, kDetour, {.deadline = TimePoint::max(), .stop = stop.get_token(), .memory = 1U << 30U}),
      HasSubstr("deadline-exceeded"));
  EXPECT_THAT(planned(kWays, kDetour, {.deadline = TimePoint::max(), .stop = {}, .memory = 1}),
              HasSubstr("resource-exhausted: no plan was found in the memory"));
}

TEST(PlannerSharedData, SolvesProblemsOfCompetitions) {
  if (const auto missing = missing_shared_data("pddl/results.csv"); !missing.empty()) GTEST_SKIP() << missing;
  for (const char* each : {"depot/p07",
                           "depot/p13",
                           "driverlog/p10",
                           "elevators-sat11-strips/p01",
                           "gripper/prob04",
                           "gripper/prob14",
                           "logistics00/probLOGISTICS-10-0",
                           "logistics00/probLOGISTICS-14-0",
                           "logistics98/prob01",
                           "logistics98/prob04",
                           "openstacks-strips/p05",
                           "openstacks-strips/p15",
                           "pipesworld-notankage/p05-net1-b10-g4",
                           "pipesworld-notankage/p15-net2-b14-g4",
                           "rovers/p10",
                           "rovers/p23",
                           "satellite/p09-pfile9",
                           "satellite/p17-pfile17",
                           "storage/p09",
                           "storage/p14",
                           "tpp/p10",
                           "tpp/p20",
                           "zenotravel/p10",
                           "zenotravel/p16"}) {
    SCOPED_TRACE(each);
    const auto folder = shared_data("pddl") / each;
    const auto domain = read_file(folder / "domain.pddl");
    const auto problem = read_file(folder / "problem.pddl");
    ASSERT_TRUE(domain && problem);
    EXPECT_THAT(planned(*domain, *problem), HasSubstr("; cost = "));
  }
}

}  // namespace
}  // namespace segue::planner
