// SPDX-License-Identifier: Apache-2.0
#include "outcome_likelihoods.hpp"

#include <segue/mission/mission.hpp>

#include <algorithm>
#include <numeric>
#include <optional>
#include <string_view>

namespace segue::mission {

namespace {

constexpr double kAsExpected = 0.8;
constexpr double kAborts = 0.05;

std::optional<double> given_likelihood(const Action& action, std::string_view outcome) {
  const auto one = std::ranges::find(action.likelihoods, outcome, &OutcomeLikelihood::outcome);
  return one == action.likelihoods.end() ? std::nullopt : std::optional(one->likelihood);
}

}  // namespace

std::vector<double> outcome_likelihoods(const Action& action, bool may_abort) {
  double rest = 1;
  double others = 0;  // outcomes of which nothing is said, the expected one aside
  bool expects = false;
  for (const std::string& outcome : action.outcomes) {
    const auto given = given_likelihood(action, outcome);
    if (given)
      rest -= *given;
    else if (outcome == action.expected_outcome)
      expects = true;
    else
      ++others;
  }
  double aborted = 0;
  if (may_abort) {
    const bool nothing_else = others == 0 && !expects;
    const double share = nothing_else ? 1 : action.expected_outcome == kAbortedName ? kAsExpected : kAborts;
    aborted = given_likelihood(action, kAbortedName).value_or(share * rest);
    rest -= aborted;
  }
  rest = std::max(rest, 0.0);
  const double expected = !expects ? 0 : others == 0 ? rest : kAsExpected * rest;
  std::vector<double> likelihoods;
  for (const std::string& outcome : action.outcomes) {
    const double left = outcome == action.expected_outcome ? expected : (rest - expected) / others;
    likelihoods.push_back(given_likelihood(action, outcome).value_or(left));
  }
  if (may_abort) likelihoods.push_back(aborted);
  const double sum = std::accumulate(likelihoods.begin(), likelihoods.end(), 0.0);
  for (double& one : likelihoods)
    one = sum > 0 ? one / sum : 1 / static_cast<double>(likelihoods.size());
  return likelihoods;
}

}  // namespace segue::mission
