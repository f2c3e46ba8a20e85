// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/solve.hpp>

#include <segue/model/files.hpp>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <support/random_transitions.hpp>
#include <support/shortest_transition.hpp>

#include <cstdlib>

/// On small networks an exhaustive search finds no shorter transition, and needs no longer one.
namespace segue::solve {
namespace {

/// SEGUE_MINIMALITY_CASES sets a larger number of cases than a run of all tests can afford.
int cases() {
  const char* wanted = std::getenv("SEGUE_MINIMALITY_CASES");
#ifdef NDEBUG
  constexpr int kCases = 3000;
#else
  constexpr int kCases = 250;
#endif
  return wanted ? std::atoi(wanted) : kCases;
}

std::string describe(const model::Transition& transition) {
  std::string text;
  for (const auto& action : transition.actions)
    text += action.label() + "\n";
  return text;
}

void check(std::uint64_t seed, const segue::testing::PairShape& shape) {
  const auto pair = segue::testing::random_pair(seed, shape);
  const auto found = diff(pair.current, pair.target, pair.catalog);
  ASSERT_TRUE(found) << to_string(found.error());
  segue::testing::ShortestTransition search(pair.current, pair.target, pair.catalog);
  // The search does not model the internal state of tasks.
  const int needed = found->counts().total() - found->counts().of(model::ActionKind::HandOver);
  ASSERT_EQ(needed, search.length()) << "seed " << seed << "\n"
                                     << describe(*found) << "from\n"
                                     << model::write_network(pair.current) << "to\n"
                                     << model::write_network(pair.target);
}

TEST(Minimality, NothingShorterLeadsToTheTarget) {
  segue::testing::PairShape shape;
  shape.tasks = 3;
  shape.processes = 2;
  shape.connections = 4;
  for (int i = 0; i < cases() && !HasFailure(); ++i)
    check(static_cast<std::uint64_t>(i), shape);
}

TEST(Minimality, NothingShorterLeadsThroughTheLifeCycleOfOneTask) {
  segue::testing::PairShape shape;
  shape.tasks = 1;
  shape.processes = 1;
  shape.connections = 2;
  for (int i = 0; i < cases() * 2 && !HasFailure(); ++i)
    check(static_cast<std::uint64_t>(i), shape);
}

}  // namespace
}  // namespace segue::solve
