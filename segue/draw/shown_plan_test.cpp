// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/concurrent_run.hpp>
#include <segue/draw/plan_diagram.hpp>
#include <segue/draw/shown_plan.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/type/json.hpp>

#include <gmock/gmock.h>

namespace segue::draw {
namespace {

using ::testing::ElementsAre;
using type::Value;

constexpr const char* kTidy = R"j(mission: tidy
actions:
  look: {outputs: {pose: map}, pure: true, run: {simulated: {duration: 1s}}}
  grasp: {inputs: {pose: map}, run: {simulated: {duration: 1s}}}
outcomes: [done, failed]
libraries:
  take:
    start: look
    flows: [look.pose -> grasp.pose]
    states:
      look: {on: {success: grasp}}
      grasp: {on: {success: return success}}
start: first
states:
  first: {library: take, on: {success: again, aborted: return failed}}
  again:
    start: look
    states: {look: {title: Look again, on: {success: return success}}}
    on: {success: return done}
)j";

mission::Mission mission_of(const std::string& text) {
  Diagnostics diagnostics;
  auto mission = mission::read_mission(text, "test.yaml", diagnostics);
  EXPECT_TRUE(mission) << to_string(diagnostics);
  return std::move(*mission);
}

const Value& at(const Value& plan, const std::string& list, std::size_t i, const std::string& key) {
  return *plan.find(list)->as_list().at(i).find(key);
}

TEST(ShownPlan, HasLibrariesWhereTheyAreUsed) {
  const auto program = mission::Program::compile(mission_of(kTidy)).value();
  const Value plan = shown_plan(*program, nullptr);
  std::vector<std::string> paths;
  for (const Value& state : plan.find("states")->as_list())
    paths.push_back(state.find("path")->as_string());
  EXPECT_THAT(paths, ElementsAre("", "first", "again", "first/look", "first/grasp", "again/look"));
  EXPECT_EQ(type::to_json(at(plan, "states", 1, "next"), -1),
            R"([{"outcome":"success","to":"again"},{"outcome":"aborted","returns":"failed"}])");
  EXPECT_EQ(at(plan, "states", 1, "start"), Value("first/look"));
  EXPECT_EQ(at(plan, "states", 1, "library"), Value("take"));
  EXPECT_EQ(type::to_json(at(plan, "states", 1, "flows"), -1),
            R"([{"from":"first/look","to":"first/grasp","what":"pose -> pose"}])");
  EXPECT_EQ(at(plan, "states", 4, "in"), Value("first"));
  EXPECT_EQ(at(plan, "states", 4, "action"), Value("grasp"));
  EXPECT_EQ(at(plan, "states", 5, "title"), Value("Look again"));
  EXPECT_TRUE(plan.find("nodes")->is_null());
  EXPECT_EQ(*plan.find("complete"), Value(true));
}

TEST(ShownPlan, SaysWhatNodesWaitFor) {
  const auto program = mission::Program::compile(mission_of(kTidy)).value();
  const auto made = convert::MissionPlan::create(program).value();
  ASSERT_TRUE(convert::plan_ahead(*made, 1000));
  const Diagram diagram = diagram_of(*made);
  const Value plan = shown_plan(*program, &diagram);
  EXPECT_EQ(at(plan, "nodes", 1, "name"), Value("first/grasp"));
  EXPECT_EQ(
      type::to_json(at(plan, "nodes", 1, "after"), -1),
      R"([{"node":0,"kind":"condition","subject":"success","because":"data pose -> pose; condition success","holds_start":true}])");
}

TEST(ShownPlan, SaysOfWhichResourcesNodesNeedUnits) {
  const auto program = mission::Program::compile(mission_of(R"j(mission: dock
resources: {localized: {observe: {task: localization, state: LOCALIZED}}}
actions: {dock: {resources: [{block: arm}, {exists: localized}, {block: localized}], run: {simulated: {duration: 1s}}}}
start: dock
states: {dock: {on: {success: return success}}}
)j"))
                           .value();
  const auto made = convert::MissionPlan::create(program).value();
  ASSERT_TRUE(convert::plan_ahead(*made, 1000));
  const Diagram diagram = diagram_of(*made);
  EXPECT_EQ(type::to_json(at(shown_plan(*program, &diagram), "nodes", 0, "units"), -1),
            R"([{"resource":"arm","observed":false},{"resource":"localized","observed":true}])");
}

TEST(ShownPlan, SaysWhichUnitsOfTheRobotStatesTake) {
  const auto program = mission::Program::compile(mission_of(R"j(mission: build
resources: {screws: {of: robot}, boxes: {of: robot}}
actions:
  mount: {resources: [{consume: screws, count: 3}, {exists: boxes}, {block: arm}, {block: boxes}], run: {simulated: {duration: 1s}}}
  make: {resources: [{create: boxes}], run: {simulated: {duration: 1s}}}
start: mount
states: {mount: {on: {success: make}}, make: {on: {success: return success}}}
)j"))
                           .value();
  const Value plan = shown_plan(*program, nullptr);
  EXPECT_EQ(type::to_json(at(plan, "states", 1, "units"), -1),
            R"([{"name":"screws","count":3},{"name":"boxes","count":1}])");
  EXPECT_EQ(plan.find("states")->as_list().at(2).find("units"), nullptr);
}

TEST(ShownPlan, IsBounded) {
  std::string text = "mission: many\nactions: {a: {}}\nkind: barrier\nstates:\n";
  for (std::size_t i = 0; i < kMostShownStates; ++i)
    text += "  s" + std::to_string(i) + ": {action: a}\n";
  text += "  last: {action: a, kind: decider, on: {success: return success}}\n";
  const auto program = mission::Program::compile(mission_of(text));
  ASSERT_TRUE(program) << to_string(program.error());
  const Value plan = shown_plan(**program, nullptr);
  EXPECT_EQ(plan.find("states")->as_list().size(), kMostShownStates);
  EXPECT_EQ(*plan.find("complete"), Value(false));
}

}  // namespace
}  // namespace segue::draw
