// SPDX-License-Identifier: Apache-2.0
//
// Who follows a mission hears of what may not begin, whichever way it runs.
#include <segue/base/virtual_clock.hpp>
#include <segue/convert/run.hpp>
#include <segue/mission/engine.hpp>
#include <segue/mission/files.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

namespace segue::convert {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::shared_ptr<const mission::Program> compiled(std::string_view text) {
  Diagnostics diagnostics;
  auto mission = mission::read_mission(text, "mission.yaml", diagnostics);
  EXPECT_TRUE(mission) << to_string(diagnostics);
  return mission::Program::compile(std::move(*mission)).value();
}

/// What a run tells.
struct Told {
  std::vector<std::string> ends{};
  std::vector<std::string> warnings{};

  [[nodiscard]] mission::ActionObserver observer() {
    return [this](const mission::ActionEvent& event) {
      if (event.kind == mission::ActionEvent::Kind::Began) return;
      std::string text = std::string(event.path) + ": " + std::string(event.outcome);
      if (!event.error.empty()) text += ", " + std::string(event.error);
      ends.push_back(std::move(text));
    };
  }
  [[nodiscard]] std::function<void(std::string)> warn() {
    return [this](std::string text) { warnings.push_back(std::move(text)); };
  }
};

Told told_sequentially(std::string_view text, const mission::Runners& runners = {}) {
  Told told;
  VirtualClock clock;
  mission::EngineOptions options;
  options.clock = &clock;
  options.observe = told.observer();
  options.warn = told.warn();
  const auto engine = mission::Engine::create(compiled(text), runners, options).value();
  EXPECT_EQ(engine->run(), mission::Engine::Progress::Ended);
  return told;
}

Told told_concurrently(std::string_view text, const mission::Runners& runners = {}) {
  Told told;
  RunOptions options;
  options.clock = cdtn::ClockKind::Virtual;
  options.observe = told.observer();
  options.warn = told.warn();
  Run::create(compiled(text), runners, {}, options).value()->run();
  return told;
}

constexpr std::string_view kActions = R"x(
mission: m
world: [ready]
actions:
  grasp: {preconditions: ["at(table)"], run: {simulated: {duration: 1s}}}
  rest: {run: {simulated: {duration: 1s}}}
)x";

TEST(RefusedStates, AreToldAsAborted) {
  const std::string text = std::string(kActions) + R"x(start: grasp
states:
  grasp: {on: {success: return success, aborted: rest}}
  rest: {on: {success: shelf}}
  shelf:
    preconditions: [lit]
    start: rest
    states: {rest: {on: {success: return success}}}
    on: {success: return success, aborted: last}
  last: {action: grasp, on: {success: return success}}
)x";
  const auto as_expected = ElementsAre(HasSubstr("grasp: aborted, its precondition at(table) does not hold"),
                                       "rest: success", HasSubstr("shelf: aborted, its precondition lit"),
                                       HasSubstr("last: aborted, its precondition at(table) does not hold"));
  EXPECT_THAT(told_sequentially(text).ends, as_expected);
  EXPECT_THAT(told_concurrently(text).ends, as_expected);
}

/// The mission itself may not begin.
TEST(RefusedStates, AreToldWhereTheyEndTheMission) {
  const std::string text = std::string(kActions) + R"x(start: shelf
states:
  shelf:
    preconditions: [lit]
    start: rest
    states: {rest: {on: {success: return success}}}
    on: {success: return success}
)x";
  EXPECT_THAT(told_sequentially(text).ends, ElementsAre(HasSubstr("shelf: aborted, its precondition lit")));
  EXPECT_THAT(told_concurrently(text).ends, ElementsAre(HasSubstr("shelf: aborted, its precondition lit")));
}

/// `give_up` succeeds once `grasp` has been tried often enough.
TEST(RefusedStates, ThatAreTriedAgainAtOnceAreWarnedOf) {
  const std::string text = std::string(kActions) + R"x(  give_up: {run: {callback: give_up}}
start: grasp
states:
  grasp: {on: {success: return success, aborted: give_up}}
  give_up: {on: {success: return success, aborted: grasp}}
)x";
  for (const auto& run : {told_sequentially, told_concurrently}) {
    int tries = 0;
    mission::Runners runners;
    runners.add("give_up", [&](mission::ActionCall&) {
      return ++tries == 1100 ? mission::Ending{0, {}} : mission::Ending{mission::kAborted, "not yet"};
    });
    const Told told = run(text, runners);
    EXPECT_EQ(tries, 1100);
    EXPECT_THAT(told.warnings, ElementsAre(HasSubstr("grasp: has aborted 1000 times in a row"),
                                           HasSubstr("give_up: has aborted 1000 times in a row")));
  }
}

}  // namespace
}  // namespace segue::convert
