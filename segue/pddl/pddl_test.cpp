// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/cdtn/concurrent_engine.hpp>
#include <segue/cdtn/critical_path.hpp>
#include <segue/cdtn/simulation.hpp>
#include <segue/pddl/pddl.hpp>
#include <support/shared_data.hpp>

#include <gmock/gmock.h>

#include <map>
#include <random>
#include <sstream>

namespace segue::pddl {
namespace {

using namespace cdtn;
std::int64_t seconds(Duration duration) {
  return duration / std::chrono::seconds(1);
}

/// Carries the plan out in random sequences that the order allows: every precondition and the goal must hold,
/// and for the epoch rule the whole final world. Knows nothing of how the order came about.
std::string wrong_linearisation(const TaskNetwork& network, const Order& order, bool whole_world,
                                int samples) {
  VersionedWorld expected = network.initial_world;
  for (std::uint32_t i = 0; i < network.size(); ++i) {
    for (const Access& access : network.accesses(NodeId{i})) {
      if (access.writes) expected.set({access.fact, access.value});
    }
  }
  std::mt19937 random(7);
  for (int sample = 0; sample < samples; ++sample) {
    std::vector<std::size_t> open(network.size());
    std::vector<NodeId> ready;
    for (std::uint32_t i = 0; i < network.size(); ++i) {
      open[i] = order.before(NodeId{i}).size();
      if (open[i] == 0) ready.push_back(NodeId{i});
    }
    VersionedWorld world = network.initial_world;
    for (std::uint32_t done = 0; done < network.size(); ++done) {
      if (ready.empty()) return "a cycle";
      std::swap(ready[std::uniform_int_distribution<std::size_t>(0, ready.size() - 1)(random)], ready.back());
      const NodeId node = ready.back();
      ready.pop_back();
      for (const Access& access : network.accesses(node)) {
        if (access.reads && world.holds(access.fact) != access.needed) {
          return network.label(node) + " needs " + network.facts.text(Literal{access.fact, access.needed});
        }
      }
      for (const Access& access : network.accesses(node)) {
        if (access.writes) world.set({access.fact, access.value});
      }
      for (const Dependency& dependency : order.after(node)) {
        if (--open[index(dependency.to)] == 0) ready.push_back(dependency.to);
      }
    }
    for (const Literal& literal : network.goal) {
      if (!world.holds(literal)) return "the goal " + network.facts.text(literal);
    }
    if (whole_world && !(world == expected)) return "another final world";
  }
  return {};
}

std::int64_t makespan(const TaskNetwork& network, const Order& order) {
  SimulatedEnvironment environment(network);
  ConcurrentEngine engine(network, order, environment);
  const RunResult result = engine.run();
  EXPECT_TRUE(result.done()) << to_string(*result.error);
  EXPECT_EQ(seconds(result.makespan), seconds(critical_path(network, order).length));
  return seconds(result.makespan);
}

using Row = std::map<std::string, std::string>;

std::vector<Row> published() {
  std::vector<Row> rows;
  const auto text = read_file(shared_data("pddl/results.csv"));
  if (!text) return rows;
  std::istringstream lines(*text);
  std::string line;
  std::vector<std::string> header;
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    std::vector<std::string> row;
    for (std::string cell; std::getline(cells, cell, ',');)
      row.push_back(cell);
    if (header.empty()) {
      header = row;
      continue;
    }
    Row& entry = rows.emplace_back();
    for (std::size_t i = 0; i < row.size(); ++i)
      entry[header[i]] = row[i];
  }
  return rows;
}

TEST(PddlSharedData, CompetitionPlansAreAsParallelAsThePublishedOnes) {
  if (const auto missing = missing_shared_data("pddl/results.csv"); !missing.empty()) GTEST_SKIP() << missing;
  const auto rows = published();
  ASSERT_FALSE(rows.empty());
  for (const Row& row : rows) {
    const auto folder = shared_data("pddl") / row.at("domain") / row.at("instance");
    const auto plan = folder / (row.at("planner") == "lama-first" ? "plan" : "plan.mp");
    SCOPED_TRACE(plan);
    Diagnostics diagnostics;
    const auto network = load_pddl(folder / "domain.pddl", folder / "problem.pddl", plan, diagnostics);
    ASSERT_TRUE(network) << to_string(diagnostics);
    EXPECT_EQ(std::to_string(network->size()), row.at("seq"));
    const Order epoch = derive_order(*network);
    EXPECT_EQ(wrong_linearisation(*network, epoch, true, 20), "");
    EXPECT_LE(makespan(*network, epoch), std::stol(row.at("epoch")));
    const Order goal = derive_order(*network, OrderRule::Goal);
    EXPECT_EQ(wrong_linearisation(*network, goal, false, 20), "");
    EXPECT_LE(makespan(*network, goal), std::stol(row.at("eog")));
  }
}

constexpr std::string_view kDomain = R"(
(define (domain Lamps) (:requirements :strips :typing :conditional-effects :negative-preconditions)
  (:types lamp room - object)
  (:constants hall - room)
  (:predicates (on ?l - lamp) (in ?l - lamp ?r - (either room lamp)) (dark ?r - room) (seen ?l - lamp))
  (:functions (total-cost))
  (:action light :parameters (?l - lamp ?r - room)
    :precondition (and (in ?l ?r) (not (on ?l)) (not (= ?l ?r)))
    :effect (and (on ?l) (when (dark ?r) (not (dark ?r))) (increase (total-cost) 1)))
  (:action look :parameters () :precondition ()
    :effect (forall (?l - lamp) (when (on ?l) (seen ?l)))))
)";
constexpr std::string_view kProblem = R"(
(define (problem two) (:domain Lamps) (:objects A B - lamp kitchen - room) ; objects
  (:init (in a hall) (in b hall) (dark hall) (= (total-cost) 0))
  (:goal (and (on a) (seen b) (not (dark hall)))) (:metric minimize (total-cost)))
)";

struct Read {
  std::optional<TaskNetwork> network;
  std::string problems;
};

Read read(std::string_view domain, std::string_view problem, std::string_view plan) {
  Diagnostics diagnostics;
  Read result;
  result.network = read_pddl({domain, "domain"}, {problem, "problem"}, {plan, "plan"}, diagnostics);
  result.problems = to_string(diagnostics);
  return result;
}

TEST(Pddl, ConditionalEffectsAreWhatTheyDoInThePlan) {
  const auto [network, problems] =
      read(kDomain, kProblem, "(LIGHT a hall)\n(light b hall)\n(look) ; cost = 3");
  ASSERT_TRUE(network) << problems;
  EXPECT_EQ(network->size(), 3U);
  EXPECT_EQ(network->accesses(NodeId{0}).size(), 3U) << "in, on, dark";
  const Order order = derive_order(*network);
  EXPECT_EQ(wrong_linearisation(*network, order, true, 10), "");
  EXPECT_EQ(seconds(critical_path(*network, order).length), 3) << "the second must find the light on";
}

TEST(Pddl, SaysWhatIsWrongAndWhere) {
  using testing::HasSubstr;
  EXPECT_THAT(read(kDomain, kProblem, "(light a hall)").problems, HasSubstr("does not reach the goal"));
  EXPECT_THAT(read(kDomain, kProblem, "(light a kitchen)").problems,
              HasSubstr("plan:1:1: error: in(a,kitchen)"));
  EXPECT_THAT(read(kDomain, kProblem, "\n (light hall a)").problems, HasSubstr("plan:2:9"));
  EXPECT_THAT(read(kDomain, kProblem, "(fly a)").problems, HasSubstr("unknown-action"));
  EXPECT_THAT(read(kDomain, kProblem, "(light a)").problems, HasSubstr("takes 2 arguments"));
  EXPECT_THAT(read(kDomain, "(define (problem x) (:init (on c)))", "").problems, HasSubstr("no constant"));
  EXPECT_THAT(read(kDomain, "(define (problem x) (:init (off a)))", "").problems, HasSubstr("no predicate"));
  EXPECT_THAT(read("(define", kProblem, "").problems, HasSubstr("domain:1:1: error: a '(' without"));
  EXPECT_THAT(read(")", kProblem, "").problems, HasSubstr("without its '('"));
  EXPECT_THAT(read(std::string(300, '('), kProblem, "").problems, HasSubstr("nested too deeply"));
}

}  // namespace
}  // namespace segue::pddl
