// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_plan/test_support.hpp>

#include <algorithm>

namespace segue::mission {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class PlannedMission : public CarryFiles {
 protected:
  std::optional<Mission> planned() {
    diagnostics_ = {};
    const auto mapping = load_mapping(folder_ / "mapping.yaml", diagnostics_);
    const auto plan = mapping ? pddl::load_pddl(mapping->domain_file, folder_ / "problem.pddl",
                                                folder_ / "plan", diagnostics_)
                              : std::nullopt;
    return plan ? planned_mission(*mapping, *plan, folder_, diagnostics_) : std::nullopt;
  }
  /// The mission read again from its file, with all checks.
  std::optional<Mission> written(const Mission& mission) {
    return load_mission_text(write_mission(mission), folder_ / "mission.yaml", {}, diagnostics_);
  }

  Diagnostics diagnostics_;
};

std::vector<std::string> texts(const std::vector<Fact>& facts) {
  std::vector<std::string> result;
  for (const Fact& fact : facts)
    result.push_back((fact.positive ? "" : "!") + to_string(fact));
  std::ranges::sort(result);
  return result;
}

TEST_F(PlannedMission, HasAStateForEachStep) {
  const auto mission = planned();
  ASSERT_TRUE(mission) << told(diagnostics_);
  const auto again = written(*mission);
  ASSERT_TRUE(again) << told(diagnostics_);
  EXPECT_EQ(again->name, "tidy_up");
  std::vector<std::string> names;
  for (const State& state : again->states)
    names.push_back(state.id.str());
  EXPECT_THAT(names, ElementsAre("tidy_up", "drive_dock_table", "take_red_table", "drive_table_dock",
                                 "put_red_dock"));
  EXPECT_EQ(again->states[1].transitions[0].to.state.str(), "take_red_table");
  EXPECT_EQ(again->states[1].transitions[1].to.outcome, "failed") << "blocked";
  EXPECT_EQ(again->states[4].transitions[0].to.outcome, "done");
}

TEST_F(PlannedMission, GivesActionsTheValuesOfTheObjects) {
  const auto mission = planned();
  ASSERT_TRUE(mission) << told(diagnostics_);
  const auto place = type::Value::map({{"x", 2.0}, {"y", 1.0}});
  EXPECT_EQ(mission->states[1].input_values[0].value, place);
  EXPECT_EQ(mission->states[2].input_values[0].value, type::Value(7));
  EXPECT_EQ(mission->states[4].input_values[0].value, type::Value(7));
}

TEST_F(PlannedMission, HasTheFactsAndTimesOfThePlan) {
  const auto mission = planned();
  ASSERT_TRUE(mission) << told(diagnostics_);
  EXPECT_THAT(texts(mission->world), ElementsAre("arm-free", "at(dock)", "on(red,table)"));
  const Action& take = mission->actions[1];
  EXPECT_THAT(texts(take.preconditions), ElementsAre("!full", "at(table)", "on(red,table)"));
  EXPECT_THAT(texts(take.effects), ElementsAre("!on(red,table)", "full", "holding(hand,red)"));
  const Action& put = mission->actions[3];
  EXPECT_EQ(put.expected_duration, std::chrono::seconds(2));
  EXPECT_THAT(texts(put.during), ElementsAre("at(dock)")) << "which is observed";
  ASSERT_EQ(put.resources.size(), 1U);
  EXPECT_EQ(put.resources[0].resource, "task:arm-free()");
}

TEST_F(PlannedMission, HoldsNegatedFactsThatDoNotHoldAtFirst) {
  write("problem.pddl",
        text_with(text_with(kCarryProblem, "(hand-empty) ", ""), "(on red table)", "(held red)"));
  write("plan", "(put red dock)\n");
  const auto mission = planned();
  ASSERT_TRUE(mission) << told(diagnostics_);
  EXPECT_THAT(texts(mission->world), testing::Contains("full"));
}

TEST_F(PlannedMission, IsTheSameFromEveryFormatOfPlans) {
  const auto expected = planned();
  ASSERT_TRUE(expected) << told(diagnostics_);
  for (const char* plan :
       {"(drive dock table)\n(take red table)\n(drive table dock)\n(put red dock)\n; cost = 4 (unit cost)\n",
        "0.000: (drive dock table) [1.000]\n1.001: (take red table) [1.000]\n2.002: (drive table dock) "
        "[1.0]\n"
        "3.003: (put red dock) [2.000]\n",
        "step 0: DRIVE DOCK TABLE\n1: TAKE RED TABLE\n2: DRIVE TABLE DOCK\n3: PUT RED DOCK\n"}) {
    write("plan", plan);
    const auto mission = planned();
    ASSERT_TRUE(mission) << told(diagnostics_);
    EXPECT_EQ(write_mission(*mission), write_mission(*expected)) << plan;
  }
}

TEST_F(PlannedMission, NumbersStepsThatComeTwice) {
  write("plan",
        "(drive dock table)(drive table dock)(drive dock table)(take red table)(drive table dock)(put red "
        "dock)");
  const auto mission = planned();
  ASSERT_TRUE(mission) << told(diagnostics_);
  EXPECT_EQ(mission->states[3].id.str(), "drive_dock_table_2");
  EXPECT_EQ(mission->states[5].id.str(), "drive_table_dock_2");
  EXPECT_TRUE(written(*mission)) << told(diagnostics_);
}

TEST_F(PlannedMission, OfNoStepsIsDoneAtOnce) {
  write("problem.pddl", text_with(kCarryProblem, "(:goal (on red dock))", "(:goal (at dock))"));
  write("plan", "; cost = 0 (unit cost)\n");
  const auto mission = planned();
  ASSERT_TRUE(mission) << told(diagnostics_);
  EXPECT_TRUE(written(*mission)) << told(diagnostics_);
}

TEST_F(PlannedMission, FindsItsScriptsFromItsOwnFolder) {
  write("mapping.yaml", text_with(kCarryMapping, "action: grip, inputs: {box: \"{b}\"}", "action: think"));
  std::filesystem::create_directories(folder_ / "made");
  const auto mapping = load_mapping(folder_ / "mapping.yaml", diagnostics_);
  ASSERT_TRUE(mapping) << told(diagnostics_);
  const auto plan =
      pddl::load_pddl(mapping->domain_file, folder_ / "problem.pddl", folder_ / "plan", diagnostics_);
  ASSERT_TRUE(plan);
  const auto mission = planned_mission(*mapping, *plan, folder_ / "made", diagnostics_);
  ASSERT_TRUE(mission);
  EXPECT_EQ(std::get<Script>(mission->actions[1].run).file, "../think.py");
}

TEST_F(PlannedMission, IsRefusedWhereTheMappingLacksSomething) {
  write("mapping.yaml", text_with(kCarryMapping, "  take: {action: grip, inputs: {box: \"{b}\"}}\n", ""));
  EXPECT_FALSE(planned());
  EXPECT_THAT(told(diagnostics_),
              HasSubstr("mapping.yaml: error: the plan needs the action 'take', which nothing carries out"));
  write("mapping.yaml", text_with(kCarryMapping, ", table: {x: 2.0, y: 1.0}", ""));
  EXPECT_FALSE(planned());
  EXPECT_EQ(
      told(diagnostics_),
      "mapping.yaml:5:10: error: the object 'table' of the problem has no value, as others of type 'place' "
      "have [no-value]");
}

}  // namespace
}  // namespace segue::mission
