// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/pddl/pddl.hpp>
#include <segue/pddl/pddl_problem.hpp>
#include <segue/task_network/concurrent_engine.hpp>
#include <segue/task_network/critical_path.hpp>
#include <segue/task_network/flat_file.hpp>
#include <segue/task_network/simulated_environment.hpp>
#include <support/shared_data.hpp>

#include <gmock/gmock.h>

#include <map>
#include <random>
#include <sstream>

namespace segue::pddl {
namespace {

using namespace task_network;
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
    const auto loaded = load_pddl(folder / "domain.pddl", folder / "problem.pddl", plan, diagnostics);
    ASSERT_TRUE(loaded) << to_string(diagnostics);
    const TaskNetwork* network = &loaded->network;
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
  if (auto read = read_pddl({domain, "domain"}, {problem, "problem"}, {plan, "plan"}, diagnostics))
    result.network = std::move(read->network);
  result.problems = to_string(diagnostics);
  if (result.problems.ends_with('\n')) result.problems.pop_back();
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
  EXPECT_THAT(read(kDomain, "(define (problem x) (:init (on c)) (:goal ()))", "").problems,
              HasSubstr("no constant"));
  EXPECT_THAT(read(kDomain, "(define (problem x) (:init (off a)) (:goal ()))", "").problems,
              HasSubstr("no predicate"));
  EXPECT_THAT(read("(define", kProblem, "").problems, HasSubstr("domain:1:1: error: a '(' without"));
  EXPECT_THAT(read(")", kProblem, "").problems, HasSubstr("without its '('"));
  EXPECT_THAT(read(std::string(300, '('), kProblem, "").problems, HasSubstr("nested too deeply"));
}

/// A domain and a problem, with the given texts at their places, and the diagnostics about them.
struct Texts {
  std::string sections{};
  std::string precondition = "(p ?x)";
  std::string effect = "(q ?x)";
  std::string init = "(p a)";
  std::string goal = "(q a)";
  std::string of_problem{};
  std::string parameters = "(?x - t)";
  std::string plan = "(act a)";
};
std::string told(const Texts& texts) {
  const std::string domain =
      "(define (domain d) (:types t) (:predicates (p ?x - t) (q ?x - t) (at ?x - t ?y - t))\n" +
      texts.sections + "\n(:action act :parameters " + texts.parameters + " :precondition\n" +
      texts.precondition + "\n:effect\n" + texts.effect + "))";
  const std::string problem = "(define (problem x) (:domain d) (:objects a b - t)\n(:init " + texts.init +
                              ")\n(:goal " + texts.goal + ")\n" + texts.of_problem + ")";
  return read(domain, problem, texts.plan).problems;
}

TEST(Pddl, RefusesByNameWhatChangesTheMeaning) {
  const std::string no = " is not supported [unsupported]";
  for (const std::string section :
       {":constraints", ":derived", ":axiom", ":event", ":process", ":method", ":task", ":htn"}) {
    EXPECT_EQ(told({.sections = "(" + section + " x)"}), "domain:2:1: error: " + section + no);
    if (section != ":task") {
      EXPECT_EQ(told({.of_problem = "(" + section + " x)"}), "problem:4:1: error: " + section + no);
    }
  }
  EXPECT_EQ(told({.precondition = "(>= (fuel) 2)"}), "domain:4:1: error: a numeric condition" + no);
  EXPECT_EQ(told({.precondition = "(= (fuel) 2)"}), "domain:4:1: error: a numeric condition" + no);
  EXPECT_EQ(told({.effect = "(when (< (fuel) 2) (q ?x))"}), "domain:6:7: error: a numeric condition" + no);
  EXPECT_EQ(told({.goal = "(preference g (q a))"}), "problem:3:8: error: a preference" + no);
  EXPECT_EQ(told({.precondition = "(or (p ?x) (q ?x))"}), "domain:4:1: error: 'or'" + no);
  EXPECT_EQ(told({.effect = "(oneof (p ?x) (q ?x))"}), "domain:6:1: error: an effect by chance" + no);
  EXPECT_EQ(told({.init = "(p a) (at 5 (p b))"}), "problem:2:14: error: a timed initial literal" + no);
}

TEST(Pddl, NamesTheFirstCauseOnceAndWhereItIs) {
  EXPECT_EQ(told({.effect = "(q ?y)"}), "domain:6:4: error: nothing gives '?y' a value [unbound-variable]");
  EXPECT_EQ(told({.effect = "(r ?x)", .plan = "(act a) (act a)"}),
            "domain:6:1: error: no predicate 'r' [unknown-predicate]");
  EXPECT_EQ(told({.precondition = "(at ?x)"}), "domain:4:1: error: 'at' takes 2 arguments, not 1 [bad-fact]");
  EXPECT_EQ(read("(define (domain d) (:predicates (p)) (:action a :effect (p)))",
                 "(define (problem x) (:domain other) (:init) (:goal (p)))", "(a)")
                .problems,
            "problem:1:21: error: the problem is of the domain 'other', not of 'd' [other-domain]");
}

TEST(Pddl, RefusesWhatIsThereTwiceOrNotAtAll) {
  using testing::HasSubstr;
  EXPECT_THAT(told({.sections = "(:predicates (r))"}),
              HasSubstr("domain:2:1: error: a second section :predicates"));
  EXPECT_THAT(told({.of_problem = "(:goal (q b))"}), HasSubstr("problem:4:1: error: a second section :goal"));
  EXPECT_THAT(told({.sections = "(:action act :effect ())"}), HasSubstr("a second action 'act'"));
  EXPECT_THAT(told({.parameters = "(?x - t ?x - t)"}), HasSubstr("a second parameter '?x'"));
  EXPECT_THAT(told({.effect = "(q ?x) :effect (p ?x)"}), HasSubstr("a second part ':effect'"));
  EXPECT_THAT(told({.effect = "(q ?x) :effect"}), HasSubstr("nothing follows ':effect'"));
  EXPECT_THAT(told({.sections = "(:constants a - object)"}),
              HasSubstr("'a' is of type object in the domain, not t"));
  EXPECT_THAT(read(kDomain, "(define (problem x) (:objects c c - lamp) (:init) (:goal ()))", "").problems,
              HasSubstr("a second object 'c'"));
  EXPECT_THAT(read(kDomain, "(define (problem x) (:init))", "").problems,
              HasSubstr("the problem has no (:goal ...)"));
  EXPECT_THAT(told({.goal = "(q a) (q b)"}), HasSubstr("a goal is one condition"));
  EXPECT_THAT(told({.sections = "(:constants a,b - t)"}), HasSubstr("'a,b' is not a name"));
  EXPECT_THAT(told({.sections = "(:constants a#1 - t)"}), HasSubstr("'a#1' is not a name"));
}

TEST(Pddl, ReadsTypesWithoutABlankBeforeThemAndAByteOrderMark) {
  EXPECT_EQ(told({.parameters = "(?x -t)"}), "");
  EXPECT_EQ(read("\xef\xbb\xbf(define (domain d) (:predicates (p)) (:action a :effect (p)))",
                 "\xef\xbb\xbf(define (problem x) (:domain d) (:init) (:goal (p)))", "\xef\xbb\xbf(a)")
                .problems,
            "");
}

/// The names of the steps that came of a plan, in a domain in which every step is possible; or what is wrong.
std::string steps_of(std::string_view plan) {
  const auto [network, problems] = read(
      "(define (domain d) (:predicates (p)) (:action go :parameters (?x ?y) :effect (p)) (:action wait "
      ":effect ()))",
      "(define (problem x) (:domain d) (:objects a b c) (:init) (:goal ()))", plan);
  if (!network) return problems;
  std::string names;
  for (std::uint32_t i = 0; i < network->size(); ++i)
    names += (i == 0 ? "" : "; ") + network->names.name((*network)[NodeId{i}].name);
  return names;
}

TEST(PddlProblem, TakesWhatWasObservedInPlaceOfWhatItSays) {
  Diagnostics diagnostics;
  const std::vector<GroundAtom> facts = {{{"at", "a"}, false}, {{"at", "b"}, true}, {{"free"}, true}};
  const auto changed = problem_with({"(define (problem P) (:domain d) ; now\n (:init (at a) (= (far a b) 2) "
                                     "(not (free)) (at c)) (:goal (at c)))",
                                     "problem"},
                                    facts, diagnostics);
  ASSERT_TRUE(changed) << to_string(diagnostics);
  EXPECT_EQ(*changed,
            "(define (problem p)\n  (:domain d)\n  (:init (= (far a b) 2) (at c) (at b) (free))\n  (:goal "
            "(at c)))\n");
  EXPECT_FALSE(problem_with({"(define (problem p) (:domain d))", "problem"}, facts, diagnostics));
  EXPECT_EQ(to_string(diagnostics),
            "problem:1:1: error: expected (define (problem ...) ... (:init ...) ...) [bad-definition]\n");
}

TEST(PddlProblem, GoesOnFromTheFirstStepsOfAPlan) {
  Diagnostics diagnostics;
  const PddlText domain = {
      "(define (domain d) (:predicates (at ?p) (seen ?p ?q) (done)) (:action go :parameters (?p ?q) "
      ":precondition (at ?p) :effect (and (not (at ?p)) (at ?q) (seen ?p ?q))) (:action end :parameters () "
      ":precondition (not (done)) :effect (done)))",
      "domain"};
  const PddlText problem = {
      "(define (problem p) (:domain d) (:objects a b) (:init (at a)) (:goal (and (done) (at a))))",
      "problem"};
  const auto plan = read_pddl(domain, problem, {"(go a b) (go b a) (end)", "plan"}, diagnostics);
  ASSERT_TRUE(plan) << to_string(diagnostics);
  const auto after = [&](std::size_t steps) {
    return problem_with(problem, effects_of(*plan, steps), diagnostics).value_or("");
  };
  EXPECT_THAT(after(0), testing::HasSubstr("(:init (at a))"));
  EXPECT_THAT(after(1), testing::HasSubstr("(at b)"));
  EXPECT_FALSE(read_pddl(domain, {after(1), "after"}, {"(go a b)", "plan"}, diagnostics)) << "it is at b";
  EXPECT_THAT(after(1), testing::HasSubstr("(seen a b)"));
  EXPECT_FALSE(read_pddl(domain, {after(2), "after"}, {"", "none"}, diagnostics)) << "it is not done";
  EXPECT_TRUE(read_pddl(domain, {after(3), "after"}, {"", "none"}, diagnostics));
}

TEST(PddlPlan, IsInTheOrderOfItsTimes) {
  EXPECT_EQ(steps_of("1.0: (go b c) [1]\n0.0: (go a b) [1]\n"), "go a b; go b c");
  EXPECT_EQ(steps_of("10: (wait)\n9: (go b c)\n9: (go a b)\n"), "go b c; go a b; wait");
  EXPECT_EQ(steps_of("1: (wait)\n(go a b)"),
            "plan:2:1: error: this step has no time, but others have [bad-plan]");
}

TEST(PddlPlan, IsReadAsPlannersPrintIt) {
  const std::string expected = "go a b; wait; go b c";
  EXPECT_EQ(steps_of("(go a b)\n(wait)\n(go b c)\n; cost = 3 (unit cost)\n"), expected);
  EXPECT_EQ(steps_of("(go a\n  b) (wait) (go b c)"), expected);
  EXPECT_EQ(steps_of("0.0003:   (GO A B)   [D:1.0000; C:0.1000]\n1.0005: (WAIT) [1]\n2 : (GO B C) [1]\n"),
            expected);
  EXPECT_EQ(steps_of("0:\n(go a b)\n1:\n(wait)\n2:\n(go b c)"), expected);
  EXPECT_EQ(
      steps_of("ff: parsing domain file\ndomain 'D' defined\n ... done.\n\n"
               "ff: found legal plan as follows\n\nstep    0: GO A B\n        1: WAIT\n        2: GO B C\n"
               "     \n\ntime spent:    0.00 seconds instantiating 6 easy, 0 hard action templates\n"),
      expected);
  EXPECT_EQ(steps_of("STEP 0: go(a,b) wait()\nSTEP 1: go(b,c)\n"), expected);
  EXPECT_EQ(steps_of("SequentialPlan:\n    go(a, b)\n    wait\n    go(b, c)\n"), expected);
  EXPECT_EQ(
      steps_of("TimeTriggeredPlan:\n    2.0: go(b, c) [1.0]\n    0.0: go(a, b) [1.0]\n    1.0: wait [1.0]\n"),
      expected);
}

TEST(PddlPlan, IsRefusedWithOneCauseWhereItIsNone) {
  using testing::AllOf;
  using testing::HasSubstr;
  using testing::Not;
  const auto one = [](const std::string& place) {
    return AllOf(HasSubstr(place + ": error: this is not a step of a plan such as"), Not(HasSubstr("\n")));
  };
  EXPECT_THAT(
      steps_of("INFO Running search.\n[t=0.01s] Solution found!\ngo a b (1)\nwait (1)\nPlan length: 2\n"),
      one("plan:1:1"));
  EXPECT_THAT(steps_of("go a b (1)\nwait (1)\n"), one("plan:1:1"));
  EXPECT_THAT(steps_of("(go a b)\nPlan cost: 1\n"), one("plan:2:1"));
  for (const char* time : {"nan", "inf", "-1", "1e999"})
    EXPECT_THAT(steps_of(std::string(time) + ": (go a b)\n0: (wait)\n"), one("plan:1:1")) << time;
  EXPECT_THAT(steps_of("PartialOrderPlan:\n  actions:\n"), HasSubstr("'partialorderplan:' is not supported"));
}

TEST(PddlPlan, IsReadAgainWhereItWasWritten) {
  const auto [network, problems] = read(
      "(define (domain d) (:predicates (p ?x) (q)) (:action a.b+c :parameters (?x) :precondition (not (q)) "
      ":effect (p ?x)))",
      "(define (problem odd/name) (:domain d) (:objects x-1 y=2 <z>) (:init) (:goal (and (p x-1) (not "
      "(q)))))",
      "(a.b+c x-1)(a.b+c y=2)(a.b+c <z>)(a.b+c x-1)");
  ASSERT_TRUE(network) << problems;
  const std::string text = write_flat_network({*network, {}});
  Diagnostics diagnostics;
  const auto again = read_flat_network(text, "again", diagnostics);
  ASSERT_TRUE(again) << to_string(diagnostics);
  EXPECT_EQ(write_flat_network(*again), text);
}

}  // namespace
}  // namespace segue::pddl
