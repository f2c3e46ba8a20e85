// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/mission.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission/pool_actions.hpp>
#include <segue/mission/program.hpp>
#include <segue/model/files.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace segue::mission {
namespace {

using ::testing::HasSubstr;

std::string mission_of(const std::string& run, const std::string& resources = "{}") {
  return "mission: m\n"
         "resources: " +
         resources +
         "\n"
         "actions:\n"
         "  plan:\n"
         "    inputs: {goal: any}\n"
         "    outputs: {length: float}\n"
         "    pure: true\n"
         "    run: {" +
         run +
         "}\n"
         "action: plan\n";
}

constexpr const char* kPlan = "pool: planner, call: {plan: {goal: '{goal}'}}, outputs: {length: length}";

std::string pool_problems(const std::string& run) {
  Diagnostics diagnostics;
  auto mission = read_mission(mission_of(run), "m.yaml", diagnostics);
  if (!mission) return to_string(diagnostics);
  diagnostics.append(validate(*mission));
  if (diagnostics.has_errors()) return to_string(diagnostics);
  auto robot = model::read_robot("robot: r\npools: {planner: {component: \"x::Planner\"}}\n", "robot.yaml",
                                 diagnostics);
  model::ComponentCatalog catalog;
  model::read_components(
      "components:\n"
      "  x::Planner:\n"
      "    operations:\n"
      "      - {name: plan, arguments: [{name: goal, type: /double}], result: /x/Route}\n"
      "      - {name: forget}\n"
      "types:\n"
      "  /x/Route: {kind: compound, size: 8, fields: [{name: length, type: /double, offset: 0}]}\n",
      "x.yaml", catalog, diagnostics);
  EXPECT_TRUE(robot && !diagnostics.has_errors()) << to_string(diagnostics);
  if (robot) check_pools(*mission, robot->pools, catalog, diagnostics);
  return to_string(diagnostics);
}

TEST(PoolActions, SurviveWritingAndReading) {
  Diagnostics diagnostics;
  const auto mission = read_mission(mission_of(std::string(kPlan) + ", timeout: 5s, outcome_from: length"),
                                    "m.yaml", diagnostics);
  ASSERT_TRUE(mission) << to_string(diagnostics);
  const auto again = read_mission(write_mission(*mission), "m.yaml", diagnostics);
  ASSERT_TRUE(again) << to_string(diagnostics);
  EXPECT_EQ(again->actions, mission->actions);
}

TEST(PoolActions, HoldAUnitForEachInstance) {
  for (const char* resources : {"{}", "{planner: {count: 3}}"}) {
    Diagnostics diagnostics;
    auto mission = read_mission(mission_of(kPlan, resources), "m.yaml", diagnostics);
    ASSERT_TRUE(mission) << to_string(diagnostics);
    const auto program = Program::compile(std::move(*mission));
    ASSERT_TRUE(program) << to_string(program.error());
    const Mission& compiled = (*program)->mission();
    ASSERT_EQ(compiled.resources.size(), 1U);
    EXPECT_EQ(compiled.resources[0].count, std::string(resources) == "{}" ? 1 : 3);
    EXPECT_TRUE(compiled.resources[0].commutes);
    ASSERT_EQ(compiled.actions[0].resources.size(), 1U);
    EXPECT_EQ(compiled.actions[0].resources[0].resource, "planner");
    const auto units = pool_units(compiled, {{"planner", {{}}, 2}});
    ASSERT_TRUE(units);
    EXPECT_EQ(*units, (UnitCounts{{"planner", 2}}));
    EXPECT_THAT(pool_units(compiled, {{"plannr", {}}}).error().message, HasSubstr("did you mean 'plannr'"));
  }
}

TEST(PoolActions, AreComparedWithTheComponent) {
  EXPECT_EQ(pool_problems(kPlan), "");
  EXPECT_THAT(pool_problems("pool: plannr, call: {plan: {goal: 1}}"), HasSubstr("[unknown-pool]"));
  EXPECT_THAT(pool_problems("pool: planner, call: {plam: {goal: 1}}"), HasSubstr("did you mean 'plan'"));
  EXPECT_THAT(pool_problems("pool: planner, call: {plan: {}}"), HasSubstr("needs the argument 'goal'"));
  EXPECT_THAT(pool_problems("pool: planner, call: {plan: {goal: 1, gaol: 1}}"),
              HasSubstr("[unknown-argument]"));
  EXPECT_THAT(pool_problems("pool: planner, call: {plan: {goal: 1}}, outputs: {length: lenght}"),
              HasSubstr("did you mean 'length'"));
  EXPECT_THAT(pool_problems("pool: planner, call: {forget: {}}, outcome_from: result"),
              HasSubstr("answers nothing"));
}

TEST(PoolActions, AreCheckedOnTheirOwn) {
  EXPECT_THAT(pool_problems("pool: planner"), HasSubstr("'call'"));
  EXPECT_THAT(pool_problems("pool: planner, call: {a: {}, b: {}}"), HasSubstr("[bad-call]"));
  EXPECT_THAT(pool_problems("pool: planner, call: {plan: [1]}"), HasSubstr("must be a map"));
  EXPECT_THAT(pool_problems("pool: planner, call: {plan: {goal: '{gaol}'}}"), HasSubstr("'gaol'"));
  EXPECT_THAT(pool_problems("pool: planner, call: {plan: {goal: 1}}, outputs: {lenght: length}"),
              HasSubstr("it has no output 'lenght'"));
  EXPECT_THAT(pool_problems("pool: planner, call: {plan: {goal: 1}}, timeout: 0s"),
              HasSubstr("[bad-duration]"));
}

}  // namespace
}  // namespace segue::mission
