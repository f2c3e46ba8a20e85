// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/controllers.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission/program.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>

namespace segue::mission {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

/// A mission of one action with that 'run'.
std::string with_run(const std::string& run) {
  return "mission: m\n"
         "actions:\n"
         "  go:\n"
         "    inputs: {where: text, goal: map}\n"
         "    outputs: {pose: map}\n"
         "    outcomes: [arrived, blocked]\n"
         "    run: {" +
         run +
         "}\n"
         "action: go\n";
}

constexpr const char* kWhole =
    "controller: 'go_{where}', set: {planner.speed.max: 0.4}, call: {planner.set_goal: {goal: '{goal}'}}, "
    "until: [{task: planner, state: arrived, outcome: arrived}, "
    "{port: planner.status, where: 'code == 3 and value < 1', outcome: blocked}, "
    "{call: planner.failed, is: true, outcome: aborted}, {after: 1min}], "
    "outputs: {pose: odometry.pose}, afterwards: stop";

std::string problems_of(const std::string& run) {
  Diagnostics diagnostics;
  const auto mission = read_mission(with_run(run), "m.yaml", diagnostics);
  if (mission) diagnostics.append(validate(*mission));
  return to_string(diagnostics);
}

TEST(ControllerFile, IsReadAndWrittenBackEqual) {
  Diagnostics diagnostics;
  const auto mission = read_mission(with_run(kWhole), "m.yaml", diagnostics);
  ASSERT_TRUE(mission) << to_string(diagnostics);
  EXPECT_TRUE(validate(*mission).empty()) << to_string(validate(*mission));
  const auto& use = std::get<ControllerUse>(mission->actions[0].run);
  EXPECT_EQ(use.set[0].member, (Member{"planner", "speed.max"}));
  ASSERT_EQ(use.until.size(), 4U);
  EXPECT_EQ(std::get<SampleShows>(std::get<RobotCondition>(use.until[1].when)).what.all.size(), 2U);
  EXPECT_EQ(use.until[3].outcome, "aborted") << "that time is up is a failure, unless said otherwise";
  EXPECT_TRUE(use.stop);
  const auto copy = read_mission(write_mission(*mission), "copy.yaml", diagnostics);
  ASSERT_TRUE(copy) << to_string(diagnostics);
  EXPECT_EQ(*copy, *mission);
}

TEST(ControllerFile, ExplainsMistakes) {
  EXPECT_THAT(problems_of("controller: go, set: {speed: 1}"),
              HasSubstr("expected a task and a member of it such as 'planner.speed', got 'speed'"));
  EXPECT_THAT(problems_of("controller: go, until: [{outcome: arrived}]"),
              HasSubstr("expected exactly one of {task, state}, {port, where}, {call, is} and {after}"));
  EXPECT_THAT(problems_of("controller: go, until: [{task: a, state: b, after: 1s}]"),
              HasSubstr("expected exactly one of"));
  EXPECT_THAT(problems_of("controller: go, until: [{port: a.b, where: 'code = 3'}]"),
              HasSubstr("'code = 3' is not a valid condition"));
  EXPECT_THAT(problems_of("controller: go, until: [{after: 1s, outcome: arived}]"),
              HasSubstr("it has no outcome 'arived', did you mean 'arrived'?"));
  EXPECT_THAT(problems_of("controller: go, outputs: {pos: a.b}"),
              HasSubstr("it has no output 'pos', did you mean 'pose'?"));
  EXPECT_THAT(problems_of("controller: 'go_{were}'"),
              HasSubstr("it uses the input 'were', which it does not have, did you mean 'where'?"));
  EXPECT_THAT(problems_of("controller: go, call: {a.b: {list: [{x: '{gaol}'}]}}"),
              HasSubstr("it uses the input 'gaol'"));
  EXPECT_THAT(problems_of("controller: go, afterwards: wait"), HasSubstr("keep"));
  EXPECT_THAT(problems_of("controller: go, python: a.py"), HasSubstr("expected exactly one of callback"));
}

TEST(Controllers, AreUsedByOneActionAtATime) {
  Diagnostics diagnostics;
  auto mission = read_mission(with_run(kWhole), "m.yaml", diagnostics);
  ASSERT_TRUE(mission);
  const auto program = Program::compile(std::move(*mission));
  ASSERT_TRUE(program);
  const auto& needs = (*program)->mission().actions[0].resources;
  ASSERT_EQ(needs.size(), 1U);
  EXPECT_EQ(needs[0].resource, kControllerResource);
  EXPECT_EQ(needs[0].operation, ResourceOperation::Block);
}

/// The resources that actions hold, which are controllers of these names.
std::vector<std::vector<std::string>> held_by(const std::vector<std::string>& controllers,
                                              const ControllerConflicts& conflicts) {
  Mission mission;
  for (const std::string& controller : controllers) {
    Action action;
    action.inputs.push_back({});
    action.inputs.back().name = "where";
    ControllerUse use;
    use.controller = controller;
    action.run = use;
    mission.actions.push_back(std::move(action));
  }
  claim_controllers(mission, &conflicts);
  std::vector<std::vector<std::string>> held;
  for (const Action& action : mission.actions) {
    held.emplace_back();
    for (const ResourceUse& use : action.resources) {
      EXPECT_EQ(std::ranges::count(mission.resources, use.resource, &Resource::name), 1);
      held.back().push_back(use.resource);
    }
  }
  return held;
}

TEST(Controllers, ThatCanRunAtOnceAreHeldByDifferentActionsAtOnce) {
  const auto held = held_by({"drive", "arm", "drive"}, {{"arm", "drive"}, {}});
  EXPECT_THAT(held[0], ElementsAre("controller drive"));
  EXPECT_THAT(held[1], ElementsAre("controller arm"));
  EXPECT_EQ(held[2], held[0]);
}

TEST(Controllers, ThatConflictAreKeptApartByWhatBothNeed) {
  const auto held = held_by({"drive", "stick", "arm"},
                            {{"arm", "drive", "stick"}, {{"drive", "stick", "input base.command"}}});
  EXPECT_THAT(held[0], ElementsAre("input base.command", "controller drive"));
  EXPECT_THAT(held[1], ElementsAre("input base.command", "controller stick"));
  EXPECT_THAT(held[2], ElementsAre("controller arm"));
}

TEST(Controllers, AreKeptApartByAsFewResourcesAsNeeded) {
  const auto held = held_by(
      {"a", "b", "c"},
      {{"a", "b", "c"},
       {{"a", "b", "task x"}, {"a", "b", "task arm"}, {"a", "c", "task arm"}, {"b", "c", "task arm"}}});
  for (const auto& resources : held) {
    EXPECT_THAT(resources, SizeIs(2));
    EXPECT_EQ(resources.front(), "task arm");
  }
}

TEST(Controllers, ThatConflictInPairsOnlyDoNotKeepOthersApart) {
  const auto held =
      held_by({"a", "b", "c"}, {{"a", "b", "c"}, {{"a", "b", "task arm"}, {"b", "c", "task arm"}}});
  EXPECT_THAT(held[0], ElementsAre("task arm of a and b", "controller a"));
  EXPECT_THAT(held[1], ElementsAre("task arm of a and b", "task arm of b and c", "controller b"));
  EXPECT_THAT(held[2], ElementsAre("task arm of b and c", "controller c"));
}

TEST(Controllers, WhoseNameAnInputDecidesHoldWhatAnyOfThemNeeds) {
  const auto held =
      held_by({"go_{where}", "stick"}, {{"go_away", "go_home", "stick", "unused"},
                                        {{"go_home", "stick", "task base"}, {"stick", "unused", "task x"}}});
  EXPECT_THAT(held[0], ElementsAre("task base", "controller go_away", "controller go_home"));
  EXPECT_THAT(held[1], ElementsAre("task base", "controller stick"));
}

/// No two actions that conflict lack a common resource, and no two that do not conflict have one.
RC_GTEST_PROP(Controllers, AreKeptApartExactlyWhereTheyConflict, ()) {
  const std::vector<std::string> names = {"a", "b", "c", "d", "e"};
  ControllerConflicts conflicts{names, {}};
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (std::size_t j = i + 1; j < names.size(); ++j) {
      for (const char* what : {"task x", "task y", "device z"}) {
        if (*rc::gen::inRange(0, 3) == 0) conflicts.pairs.push_back({names[i], names[j], what});
      }
    }
  }
  const auto held = held_by(names, conflicts);
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (std::size_t j = i + 1; j < names.size(); ++j) {
      const bool apart = std::ranges::any_of(
          held[i], [&](const auto& resource) { return std::ranges::count(held[j], resource) > 0; });
      RC_ASSERT(apart == conflicts.conflict(names[i], names[j]));
    }
  }
}

class RobotWithControllers : public ::testing::Test {
 protected:
  RobotWithControllers() {
    model::ComponentModel planner;
    planner.name = model::ComponentName("nav::Planner");
    planner.properties.push_back({});
    planner.properties.back().name = "speed";
    planner.operations = {{"set_goal", {{"goal", "/Point", ""}}, "", false, ""},
                          {"failed", {}, "bool", false, ""}};
    planner.ports.push_back({});
    planner.ports.back().name = "status";
    planner.ports.back().direction = model::Direction::Output;
    planner.nominal_states = {"arrived"};
    catalog_.add(planner);
    add("go_home");
    add("go_away");
  }

  void add(const std::string& name) {
    model::Network network;
    network.name = model::NetworkName(name);
    for (const auto& [id, component] : {std::pair{"planner", "nav::Planner"}, {"odometry", "nav::Unknown"}}) {
      model::Task task;
      task.id = model::TaskId(id);
      task.component = model::ComponentName(component);
      network.tasks.push_back(task);
    }
    networks_.push_back(std::move(network));
  }

  std::string problems_of(const std::string& run) {
    Diagnostics diagnostics;
    const auto mission = read_mission(with_run(run), "m.yaml", diagnostics);
    EXPECT_TRUE(mission) << to_string(diagnostics);
    if (mission) check_controllers(*mission, networks_, catalog_, diagnostics);
    return to_string(diagnostics);
  }

  model::ComponentCatalog catalog_;
  std::vector<model::Network> networks_;
};

TEST_F(RobotWithControllers, HasWhatAMissionAsksOfIt) {
  EXPECT_EQ(problems_of(kWhole), "");
}

TEST_F(RobotWithControllers, LacksWhatItLacksInEveryControllerThatIsMeant) {
  EXPECT_THAT(problems_of("controller: go_hom"),
              HasSubstr("the robot has no controller 'go_hom', did you mean 'go_home'?"));
  const std::string twice = problems_of("controller: 'go_{where}', set: {planner.sped: 1}");
  EXPECT_THAT(twice, HasSubstr("in controller 'go_home', task 'planner' has no property 'sped', did you "
                               "mean 'speed'? [unknown-property]"));
  EXPECT_THAT(twice, HasSubstr("in controller 'go_away'"));
  EXPECT_THAT(problems_of("controller: go_home, set: {planer.speed: 1}"),
              HasSubstr("there is no task 'planer', did you mean 'planner'?"));
  EXPECT_THAT(problems_of("controller: go_home, call: {planner.set_gaol: {goal: 1}}"),
              HasSubstr("has no operation 'set_gaol', did you mean 'set_goal'?"));
  const std::string arguments = problems_of("controller: go_home, call: {planner.set_goal: {gaol: 1}}");
  EXPECT_THAT(arguments, HasSubstr("planner.set_goal needs the argument 'goal'"));
  EXPECT_THAT(arguments, HasSubstr("planner.set_goal has no argument 'gaol', did you mean 'goal'?"));
  EXPECT_THAT(problems_of("controller: go_home, until: [{port: planner.stat, where: 'a == 1'}]"),
              HasSubstr("has no output port 'stat', did you mean 'state'? [unknown-port]"));
  EXPECT_THAT(problems_of("controller: go_home, until: [{task: planner, state: arived}]"),
              HasSubstr("has no state 'arived', did you mean 'arrived'?"));
  EXPECT_THAT(problems_of("controller: go_home, until: [{call: planner.set_goal, is: true}]"),
              HasSubstr("has arguments, so a condition cannot ask it"));
}

TEST_F(RobotWithControllers, LacksWhatShowsTheUnitsOfAResource) {
  const auto problems = [&](const std::string& observe) {
    Diagnostics diagnostics;
    const auto mission =
        read_mission("mission: m\nresources: {pose: {observe: " + observe + "}}\n", "m.yaml", diagnostics);
    EXPECT_TRUE(mission) << to_string(diagnostics);
    if (mission) check_controllers(*mission, networks_, catalog_, diagnostics);
    return to_string(diagnostics);
  };
  EXPECT_EQ(problems("{task: planner, state: arrived}"), "");
  EXPECT_EQ(problems("{port: planner.status, units: free}"), "");
  EXPECT_THAT(
      problems("{task: planer, state: arrived}"),
      HasSubstr(
          "the resource 'pose': no controller of the robot has a task 'planer', did you mean 'planner'?"));
  EXPECT_THAT(problems("{port: planner.stats, units: free}"),
              HasSubstr("has no output port 'stats', did you mean 'status'? [unknown-port]"));
}

TEST(RobotsOfMissions, KeepTheUnitsThatAMissionSaysTheyDo) {
  const auto problems = [&](const std::vector<model::UnitStock>& units) {
    Diagnostics diagnostics;
    const auto mission = read_mission("mission: m\nresources: {screws: {of: robot}, room: {count: 3}}\n",
                                      "m.yaml", diagnostics);
    EXPECT_TRUE(mission) << to_string(diagnostics);
    if (mission) check_robot_units(*mission, units, diagnostics);
    return to_string(diagnostics);
  };
  EXPECT_EQ(problems({{"nuts", 1}, {"screws", 0}}), "");
  EXPECT_THAT(
      problems({{"screw", 1}}),
      HasSubstr("m.yaml:2:21: error: resource 'screws': the robot file has no such units, did you mean "
                "'screw'? [unknown-units]"));
  EXPECT_THAT(problems({}), HasSubstr("the robot file has no such units, as in `units: {screws: 3}`"));
}

}  // namespace
}  // namespace segue::mission
