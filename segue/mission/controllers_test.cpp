// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/controllers.hpp>
#include <segue/mission/files.hpp>
#include <segue/mission/program.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace segue::mission {
namespace {

using ::testing::HasSubstr;

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
  EXPECT_EQ(std::get<SampleShows>(use.until[1].when).what.all.size(), 2U);
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
              HasSubstr("'code = 3' is no condition"));
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
              HasSubstr("cannot be asked for the end of an action"));
}

}  // namespace
}  // namespace segue::mission
