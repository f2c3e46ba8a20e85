// SPDX-License-Identifier: Apache-2.0
//
// Random controllers on several hosts, and trouble of every kind at random steps of the switches between
// them: messages are lost, hosts and daemons start again, other runtimes take the robot, processes die. After
// each request all hosts that can be reached run what it leads to, or what was there before, or it is
// reported what runs; a request that needs a lost host is refused before anything changes; once all is well
// again, one request leads to what it says and leaves nothing else.
//
// SEGUE_HOSTS_ROUNDS sets the number of rounds. RC_PARAMS="seed=N" repeats a run; the line that a failure
// prints repeats and shrinks its scenario alone.
#include "switch_rounds.hpp"

#include <segue/base/log.hpp>

#include <support/sanitizers.hpp>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <sstream>
#include <vector>

namespace segue::distributed::testing {

void showValue(const Round& round, std::ostream& out) {
  out << "\n  controller " << round.controller << (round.paper ? ", order paper" : "")
      << (round.restart ? ", the runtime restarts" : "");
  if (round.cut >= 0) {
    out << ", h" << round.cut << " is lost";
  }
  for (const auto& trouble : round.troubles) {
    out << ", " << to_string(trouble);
  }
  out << (round.heal ? ", then all is well" : "");
}

void showValue(const Scenario& scenario, std::ostream& out) {
  out << scenario.hosts << " hosts, optional " << scenario.optional << ", networks " << scenario.networks;
  rc::show(scenario.rounds, out);
}

namespace {

constexpr int kRounds = kSanitized ? 50 : 250;
constexpr int kMostRounds = 5;  ///< of a scenario
constexpr int kMostHosts = 4;

/// At most so many of these, whatever the size of the test case.
template <class T>
rc::Gen<std::vector<T>> some(int most, const rc::Gen<T>& one) {
  return rc::gen::withSize([most, one](int size) {
    return rc::gen::resize(most, rc::gen::container<std::vector<T>>(rc::gen::resize(size, one)));
  });
}

using Kinds = std::vector<TroubleKind>;

Kinds all_kinds() {
  Kinds kinds;
  for (std::size_t i = 0; i < kTroubleKinds; ++i) {
    kinds.push_back(static_cast<TroubleKind>(i));
  }
  return kinds;
}

rc::Gen<Trouble> any_trouble(int hosts, const Kinds& kinds) {
  return rc::gen::mapcat(rc::gen::elementOf(kinds), [hosts](TroubleKind kind) {
    // The first two calls, actions and commits, are where most can happen.
    const auto call = is_of_process(kind)
                          ? rc::gen::inRange(1, 120)
                          : rc::gen::oneOf(rc::gen::inRange(0, 2), rc::gen::inRange<int>(0, kCalls.size()));
    const auto nth = rc::gen::map(rc::gen::inRange(0, 8), [](int drawn) { return std::max(1, drawn - 3); });
    return rc::gen::build<Trouble>(rc::gen::set(&Trouble::kind, rc::gen::just(kind)),
                                   rc::gen::set(&Trouble::host, rc::gen::inRange(0, hosts)),
                                   rc::gen::set(&Trouble::call, call), rc::gen::set(&Trouble::nth, nth));
  });
}

rc::Gen<bool> one_in(int chances) {
  return rc::gen::map(rc::gen::inRange(0, chances), [chances](int drawn) { return drawn == chances - 1; });
}

rc::Gen<Round> any_round(int hosts, const Kinds& kinds) {
  const auto cut = rc::gen::map(rc::gen::inRange(0, 4 * hosts),
                                [hosts](int drawn) { return drawn < 3 * hosts ? -1 : drawn - 3 * hosts; });
  return rc::gen::build<Round>(rc::gen::set(&Round::controller, rc::gen::inRange(0, kControllers)),
                               rc::gen::set(&Round::paper, one_in(6)),
                               rc::gen::set(&Round::troubles, some(3, any_trouble(hosts, kinds))),
                               rc::gen::set(&Round::cut, cut), rc::gen::set(&Round::restart, one_in(12)),
                               rc::gen::set(&Round::heal, one_in(2)));
}

rc::Gen<Scenario> any_scenario(const Kinds& kinds) {
  const auto with = [kinds](int hosts) {
    return rc::gen::build<Scenario>(
        rc::gen::set(&Scenario::hosts, rc::gen::just(hosts)),
        rc::gen::set(&Scenario::optional, rc::gen::inRange(0U, 1U << hosts)),
        rc::gen::set(&Scenario::networks, rc::gen::inRange<std::uint64_t>(0, 100'000)),
        rc::gen::set(&Scenario::rounds, some(kMostRounds, any_round(hosts, kinds))));
  };
  return rc::gen::resize(rc::kNominalSize, rc::gen::mapcat(rc::gen::inRange(2, kMostHosts + 1), with));
}

std::string shown(const Scenario& scenario) {
  std::ostringstream text;
  showValue(scenario, text);
  return text.str();
}

int wanted_rounds() {
  const char* text = std::getenv("SEGUE_HOSTS_ROUNDS");
  return text == nullptr ? kRounds : std::atoi(text);
}

TEST(TroubledSwitch, LeadsToItsTargetOrBackOrSaysWhatRuns) {
  set_log_level(LogLevel::Warning);
  auto params = rc::detail::configuration().testParams;
  Ends ends;
  int rounds = 0;
  std::string first;  // what depends on the order of threads may not be there again when it is shrunk
  params.maxSuccess = 2 * wanted_rounds() / kMostRounds + 1;
  rc::detail::TestMetadata metadata;
  metadata.id = "TroubledSwitch";
  const auto result = rc::detail::checkTestable(
      [&] {
        const auto scenario = *any_scenario(all_kinds());
        rounds += static_cast<int>(scenario.rounds.size());
        if (const auto wrong = run(scenario, Planted::Nothing, ends); !wrong.empty()) {
          if (first.empty()) {
            first = shown(scenario) + "\n" + wrong;
            // At once, since shrinking may take longer than the test is given.
            std::cout << "seed " << params.seed << ", first seen in " << first << std::endl;
          }
          RC_FAIL(wrong);
        }
      },
      metadata, params);
  std::ostringstream text;
  printResultMessage(result, text);
  EXPECT_TRUE(result.is<rc::detail::SuccessResult>()) << "seed " << params.seed << "\n"
                                                      << text.str() << "\nfirst seen in " << first;
  std::cout << rounds << " rounds:";
  for (const auto& [what, count] : ends.counts) {
    std::cout << ' ' << what << ' ' << count << ',';
  }
  std::cout << std::endl;
}

struct PlantedDefect {
  Planted planted;
  Kinds kinds;  ///< trouble that shows it
};

class PlantedDefects : public ::testing::TestWithParam<PlantedDefect> {};

TEST_P(PlantedDefects, AreFound) {
  auto params = rc::detail::configuration().testParams;
  params.maxSuccess = 200;
  params.disableShrinking = true;
  set_log_level(LogLevel::Warning);
  Ends ends;
  const auto result = rc::detail::checkTestable(
      [&] {
        const auto scenario = *any_scenario(GetParam().kinds);
        if (const auto wrong = run(scenario, GetParam().planted, ends); !wrong.empty()) {
          RC_FAIL(wrong);
        }
      },
      rc::detail::TestMetadata{}, params);
  ASSERT_TRUE(result.is<rc::detail::FailureResult>()) << to_string(GetParam().planted) << " was not found";
  RecordProperty("scenarios_before", result.get<rc::detail::FailureResult>().numSuccess);
}

std::string name_of(const ::testing::TestParamInfo<PlantedDefect>& info) {
  std::string name;
  for (const char c : to_string(info.param.planted)) {
    name += c == ' ' ? '_' : c;
  }
  return name;
}

INSTANTIATE_TEST_SUITE_P(OfEachKind, PlantedDefects,
                         ::testing::Values(PlantedDefect{Planted::LostCommitCountsAsDone, all_kinds()},
                                           PlantedDefect{Planted::LostActionsCountAsDone, all_kinds()},
                                           PlantedDefect{Planted::OldViewCountsAsPresent, all_kinds()},
                                           PlantedDefect{Planted::LeaseIsNotChecked, {TroubleKind::Rival}},
                                           PlantedDefect{Planted::PromiseLasts, {TroubleKind::LateCommit}},
                                           PlantedDefect{Planted::RefusalCountsAsPromise, all_kinds()},
                                           PlantedDefect{Planted::EndedProcessLivesOn, all_kinds()}),
                         name_of);

}  // namespace
}  // namespace segue::distributed::testing
