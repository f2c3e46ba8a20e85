// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/outcome_likelihoods.hpp>

#include <gmock/gmock.h>

namespace segue::mission {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;

auto near(double likelihood) {
  return DoubleNear(likelihood, 1e-9);
}

Action looking() {
  Action action;
  action.outcomes = {"found", "nothing", "blocked"};
  return action;
}

TEST(OutcomeLikelihoods, AllAreAlikeWhereNothingIsSaid) {
  EXPECT_THAT(outcome_likelihoods(looking(), false), ElementsAre(near(1. / 3), near(1. / 3), near(1. / 3)));
  EXPECT_THAT(outcome_likelihoods({}, false), ElementsAre(near(1)));
}

TEST(OutcomeLikelihoods, TheExpectedOneHasFourFifths) {
  Action action = looking();
  action.expected_outcome = "nothing";
  EXPECT_THAT(outcome_likelihoods(action, false), ElementsAre(near(0.1), near(0.8), near(0.1)));
}

TEST(OutcomeLikelihoods, ThatItAbortsTakesOneInTwentyUnlessItIsSaid) {
  Action action;
  EXPECT_THAT(outcome_likelihoods(action, true), ElementsAre(near(0.95), near(0.05)));
  action.likelihoods = {{"aborted", 0.5}};
  EXPECT_THAT(outcome_likelihoods(action, true), ElementsAre(near(0.5), near(0.5)));
  action.likelihoods.clear();
  action.expected_outcome = "aborted";
  EXPECT_THAT(outcome_likelihoods(action, true), ElementsAre(near(0.2), near(0.8)));
}

TEST(OutcomeLikelihoods, WhatIsSaidCountsAndTheOthersShareTheRest) {
  Action action = looking();
  action.likelihoods = {{"found", 0.7}};
  EXPECT_THAT(outcome_likelihoods(action, false), ElementsAre(near(0.7), near(0.15), near(0.15)));
  action.expected_outcome = "blocked";
  EXPECT_THAT(outcome_likelihoods(action, false), ElementsAre(near(0.7), near(0.06), near(0.24)));
}

TEST(OutcomeLikelihoods, TheyAddUpToOneWhateverIsSaid) {
  Action action = looking();
  action.likelihoods = {{"found", 0.1}, {"nothing", 0.1}, {"blocked", 0.2}};
  EXPECT_THAT(outcome_likelihoods(action, false), ElementsAre(near(0.25), near(0.25), near(0.5)));
  action.likelihoods = {{"found", 0}, {"nothing", 0}, {"blocked", 0}};
  EXPECT_THAT(outcome_likelihoods(action, false), ElementsAre(near(1. / 3), near(1. / 3), near(1. / 3)));
}

}  // namespace
}  // namespace segue::mission
