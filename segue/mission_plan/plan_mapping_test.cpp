// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_plan/test_support.hpp>

namespace segue::mission {
namespace {

class Mapping : public CarryFiles {
 protected:
  /// The diagnostics of the mapping with one text in place of another.
  std::string told_with(std::string_view old, std::string_view with) {
    write("mapping.yaml", text_with(kCarryMapping, old, with));
    Diagnostics diagnostics;
    const auto mapping = load_mapping(folder_ / "mapping.yaml", diagnostics);
    EXPECT_EQ(mapping.has_value(), !diagnostics.has_errors());
    return told(diagnostics);
  }
};

TEST_F(Mapping, BindsActionsObjectsAndFacts) {
  Diagnostics diagnostics;
  const auto mapping = load_mapping(folder_ / "mapping.yaml", diagnostics);
  ASSERT_TRUE(mapping) << to_string(diagnostics);
  EXPECT_EQ(told(diagnostics), "");
  EXPECT_EQ(mapping->name, "carry");
  const BoundAction* drive = mapping->find_action("drive");
  ASSERT_NE(drive, nullptr);
  EXPECT_EQ(drive->action.name.str(), "go");
  EXPECT_EQ(drive->action.expected_outcome, "there");
  ASSERT_NE(mapping->find_action("put"), nullptr);
  EXPECT_TRUE(std::holds_alternative<ControllerUse>(mapping->find_action("put")->action.run));
  ASSERT_NE(mapping->find_predicate("hand-empty"), nullptr);
  EXPECT_FALSE(mapping->find_predicate("hand-empty")->fact.positive);
}

TEST_F(Mapping, SaysWhatIsUnknownAndWhere) {
  EXPECT_EQ(
      told_with("  drive: {", "  drvie: {"),
      "mapping.yaml:11:10: error: the domain has no action 'drvie', did you mean 'drive'? [unknown-action]");
  EXPECT_EQ(
      told_with("action: grip", "action: grib"),
      "mapping.yaml:12:18: error: action 'take': the library has no action 'grib', did you mean 'grip'? "
      "[unknown-action]");
  EXPECT_EQ(told_with("inputs: {box: \"{b}\"}", "inputs: {box: \"{c}\"}"),
            "mapping.yaml:12:38: error: action 'take' has no parameter 'c' [unknown-parameter]");
  EXPECT_EQ(told_with("inputs: {box: ", "inputs: {bax: "),
            "mapping.yaml:12:38: error: action 'take': 'grip' has no input 'bax', did you mean 'box'? "
            "[unknown-input]\n"
            "mapping.yaml:12:9: error: action 'take': nothing gives the input 'box' a value [missing-input]");
  EXPECT_EQ(told_with("outcome: there", "outcome: here"),
            "mapping.yaml:11:57: error: action 'drive': 'go' has no outcome 'here' [unknown-outcome]");
  EXPECT_EQ(told_with("  held: ", "  hold: "),
            "mapping.yaml:9:9: error: the domain has no predicate 'hold', did you mean 'held'? "
            "[unknown-predicate]");
  EXPECT_EQ(told_with("{b})\"\nactions", "{p})\"\nactions"),
            "mapping.yaml:9:9: error: predicate 'held' has no parameter 'p' [unknown-parameter]");
  EXPECT_EQ(told_with("  box: {red", "  bax: {red"),
            "mapping.yaml:6:8: error: the domain has no type 'bax' [unknown-type]");
  EXPECT_THAT(
      told_with("library: hands", "libary: hands"),
      testing::HasSubstr("mapping.yaml:3:9: error: the mapping: the key 'libary' is not known, did you mean "
                         "'library'? [unknown-key]"));
}

TEST_F(Mapping, FindsValuesThatInputsDoNotTake) {
  EXPECT_EQ(
      told_with("red: 7", "red: seven"),
      "mapping.yaml:6:14: error: action 'take': the input 'box' takes int, but the object 'red' is 'seven' "
      "[type-mismatch]");
}

TEST_F(Mapping, WarnsOfActionsThatNothingCarriesOut) {
  EXPECT_EQ(
      told_with("  take: {action: grip, inputs: {box: \"{b}\"}}\n", ""),
      "mapping.yaml:1:1: warning: nothing carries out the action 'take' of the domain: plans with it are "
      "refused [unbound-action]");
}

TEST_F(Mapping, TellsWhatObservedFactsAreInTheDomain) {
  Diagnostics diagnostics;
  const auto mapping = load_mapping(folder_ / "mapping.yaml", diagnostics);
  ASSERT_TRUE(mapping) << to_string(diagnostics);
  const auto atom = [&](std::string_view fact, bool holds) -> std::string {
    const auto found = observed_atom(*mapping, *parse_fact(fact, ""), holds);
    if (!found) return "";
    std::string text = found->holds ? "" : "not";
    for (const std::string& word : found->words)
      text += (text.empty() ? "" : " ") + word;
    return text;
  };
  EXPECT_EQ(atom("at(dock)", true), "at dock");
  EXPECT_EQ(atom("at(dock)", false), "not at dock");
  EXPECT_EQ(atom("full()", true), "not hand-empty") << "which it negates";
  EXPECT_EQ(atom("holding(hand,red)", true), "held red");
  EXPECT_EQ(atom("holding(foot,red)", true), "");
  EXPECT_EQ(atom("at(dock,now)", true), "");
}

TEST_F(Mapping, SaysWhatIsWrongWithItsDomain) {
  write("carry.pddl", "(define (domain carry) (:predicates (p) (p)))");
  EXPECT_THAT(told_with("carry", "carry"), testing::HasSubstr("carry.pddl:1:41: error: "));
  EXPECT_THAT(told_with("domain: carry.pddl", "domain: missing.pddl"), testing::HasSubstr("missing.pddl"));
}

}  // namespace
}  // namespace segue::mission
