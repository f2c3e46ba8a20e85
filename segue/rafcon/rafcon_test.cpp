// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/rafcon/rafcon.hpp>
#include <segue/type/json.hpp>

#include <support/paths.hpp>
#include <support/shared_data.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

namespace segue::mission {
namespace {

using std::filesystem::path;
using ::testing::AllOf;
using ::testing::HasSubstr;

const path kOurs = segue::paths::in_sources("/tests/rafcon");
const std::string kReal = "rafcon/DLR-RM+RAFCON";  // of the shared data

/// Where RAFCON's own tests look for libraries.
std::vector<RafconLibraryPath> real_paths() {
  const path share = shared_data(kReal) / "source/rafcon/share/rafcon";
  const path tests = shared_data(kReal) / "tests/assets/unit_test_state_machines";
  return {{"generic", share / "libraries/generic"},
          {"tutorials", share / "examples/tutorials"},
          {"turtle_libraries", share / "examples/libraries/turtle_libraries"},
          {"ros", share / "examples/libraries/ros_libraries"},
          {"ros_libraries", share / "examples/libraries/ros_libraries"},
          {"develop_test", tests / "start_from_here_test/develop_test_libraries"},
          {"unit_test_state_machines", tests}};
}

/// RAFCON's own result: the counts, or an error.
struct Expected {
  path folder;
  bool ok = false;
  RafconCounts counts;
  std::string error;
};

std::vector<Expected> oracle() {
  std::vector<Expected> rows;
  std::istringstream lines(read_file(shared_data("rafcon/oracle_load.jsonl")).value_or(""));
  const auto number = [](const type::Value& row, std::string_view key) {
    const type::Value* value = row.find(key);
    return value == nullptr ? 0 : value->as_uint();
  };
  for (std::string line; std::getline(lines, line);) {
    const auto row = type::parse_json(line);
    if (!row) continue;
    Expected expected;
    expected.folder = shared_data(kReal) / row->find("path")->as_string();
    expected.ok = row->find("ok")->as_bool();
    expected.counts = {number(*row, "states_expanded"), number(*row, "library_states"),
                       number(*row, "transitions"), number(*row, "data_flows")};
    if (!expected.ok) expected.error = row->find("error")->as_string();
    rows.push_back(std::move(expected));
  }
  return rows;
}

std::string told(const RafconCounts& counts) {
  return std::to_string(counts.states) + " states, " + std::to_string(counts.library_states) +
         " library states, " + std::to_string(counts.transitions) + " transitions, " +
         std::to_string(counts.data_flows) + " data flows";
}

TEST(RafconMachinesSharedData, LoadAsRafconLoadsThem) {
  if (const auto missing = missing_shared_data(kReal); !missing.empty()) GTEST_SKIP() << missing;
  const auto rows = oracle();
  ASSERT_GT(rows.size(), 100U);
  for (const Expected& expected : rows) {
    Diagnostics diagnostics;
    const auto import = import_rafcon(expected.folder, real_paths(), diagnostics);
    // A module that Python lacked is nothing to us.
    if (expected.error.starts_with("ModuleNotFoundError")) continue;
    EXPECT_EQ(import.has_value(), expected.ok) << expected.folder << "\n"
                                               << to_string(diagnostics) << expected.error;
    if (expected.error.starts_with("LibraryNotFound")) {
      EXPECT_THAT(to_string(diagnostics), HasSubstr("missing-library"));
    }
    if (!import) continue;
    EXPECT_EQ(told(import->counts), told(expected.counts)) << expected.folder;
    Diagnostics again;
    const auto copy = read_mission(write_mission(import->mission), "written.yaml", again);
    EXPECT_TRUE(copy) << expected.folder << "\n" << to_string(again);
    EXPECT_TRUE(copy && *copy == import->mission) << expected.folder;
  }
}

class OwnMachine : public ::testing::Test {
 protected:
  std::optional<RafconImport> import(const std::string& name) {
    return import_rafcon(kOurs / name, {{"own", kOurs / "libraries"}}, diagnostics_);
  }
  Diagnostics diagnostics_;
};

TEST_F(OwnMachine, OfTheNewFormatIsRead) {
  const auto machine = import("count_down");
  ASSERT_TRUE(machine) << to_string(diagnostics_);
  EXPECT_EQ(told(machine->counts), told({4, 1, 4, 4}));
  const Mission& mission = machine->mission;
  EXPECT_EQ(mission.name, "Count_down");
  EXPECT_EQ(mission.root().title, "Count down");
  EXPECT_EQ(mission.libraries.front().name, "own/tools/show_value");
  EXPECT_TRUE(validate(mission).empty()) << to_string(validate(mission));
}

TEST_F(OwnMachine, KeepsScriptsNotesAndValues) {
  const auto machine = import("count_down");
  ASSERT_TRUE(machine) << to_string(diagnostics_);
  const auto find = [&](std::string_view title) {
    return *std::ranges::find_if(machine->mission.states,
                                 [&](const State& s) { return s.title == title || s.id.str() == title; });
  };
  const State step = find("step down");
  EXPECT_NE(step.notes.find("resources"), nullptr);
  const auto action = std::ranges::find(machine->mission.actions, step.action, &Action::name);
  EXPECT_THAT(std::get<Script>(action->run).text, HasSubstr("def execute"));
  EXPECT_EQ(action->outcomes, (std::vector<std::string>{">0", "==0"}));
  EXPECT_EQ(find("show").input_values, (std::vector<PortValue>{{"text", "left: ", {}}}));
}

TEST_F(OwnMachine, DeclaresForSegueWhatAMissionFileWould) {
  const auto folder =
      std::filesystem::path(::testing::TempDir()) / ("segue_declares_" + std::to_string(::getpid()));
  std::filesystem::remove_all(folder);
  std::filesystem::copy(kOurs / "count_down", folder, std::filesystem::copy_options::recursive);
  const auto declare = [&](const std::filesystem::path& state, const std::string& text) {
    ASSERT_TRUE(write_file(folder / state / "semantic_data.json", text));
  };
  declare("", R"j({"segue": {"world": "[\"at(robot, dock)\"]", "resources": {"arm": {"count": "2"}}}})j");
  declare("step down_STEPAA", R"j({"other": "x", "segue": {"pure": "true", "expect": {},
      "preconditions": "at(robot, dock)", "effects": ["+counted()", "-fresh()"],
      "resources": "[{block: arm, count: 2}]", "isolated": "true"}})j");
  auto machine = import_rafcon(folder, {{"own", kOurs / "libraries"}}, diagnostics_);
  ASSERT_TRUE(machine) << to_string(diagnostics_);
  const Mission& mission = machine->mission;
  const auto step = std::ranges::find_if(mission.actions, [](const Action& each) { return each.pure; });
  ASSERT_NE(step, mission.actions.end());
  EXPECT_EQ(step->preconditions.size(), 1U);
  EXPECT_EQ(step->effects.size(), 2U);
  EXPECT_EQ(step->resources.at(0).count, 2);
  EXPECT_TRUE(std::get<Script>(step->run).isolated);
  EXPECT_EQ(mission.world.size(), 1U);
  EXPECT_EQ(mission.resources.at(0).name, "arm");
  EXPECT_TRUE(validate(mission).empty()) << to_string(validate(mission));

  declare("step down_STEPAA", R"j({"segue": {"effect": "+counted()"}})j");
  EXPECT_FALSE(import_rafcon(folder, {{"own", kOurs / "libraries"}}, diagnostics_));
  EXPECT_THAT(to_string(diagnostics_), HasSubstr("semantic_data.json"));
  EXPECT_THAT(to_string(diagnostics_), HasSubstr("'effects'"));
  std::filesystem::remove_all(folder);
}

/// A copy of one of our machines, to be changed.
class ChangedMachine : public ::testing::Test {
 protected:
  void copy(const std::string& name) {
    folder_ =
        std::filesystem::path(::testing::TempDir()) / ("segue_changed_" + name + std::to_string(::getpid()));
    std::filesystem::remove_all(folder_);
    std::filesystem::copy(kOurs / name, folder_, std::filesystem::copy_options::recursive);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  void write(const std::filesystem::path& file, const std::string& text) {
    ASSERT_TRUE(write_file(folder_ / file, text));
  }
  void replace(const std::filesystem::path& file, const std::string& from, const std::string& to) {
    std::string text = read_file(folder_ / file).value();
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << text;
    write(file, text.replace(at, from.size(), to));
  }
  std::optional<RafconImport> import(const std::filesystem::path& libraries = kOurs / "libraries") {
    return import_rafcon(folder_, {{"own", libraries}}, diagnostics_);
  }

  std::filesystem::path folder_;
  Diagnostics diagnostics_;
};

TEST_F(ChangedMachine, WithTitlesInOtherAlphabetsHasIdentifiersThatTell) {
  copy("live_objects");
  replace("opens_OPENAA/core_data.json", "\"opens\"", "\"\u958b\u304f\"");
  replace("uses_USESAA/core_data.json", "\"uses\"", "\"Gr\u00f6\u00dfe\"");
  const auto machine = import();
  ASSERT_TRUE(machine) << to_string(diagnostics_);
  std::vector<std::string> states;
  for (const State& state : machine->mission.states)
    states.push_back(state.id.str() + " = " + state.title);
  EXPECT_EQ(states, (std::vector<std::string>{"live_objects = live objects", "OPENAA = \u958b\u304f",
                                              "Gr__e = Gr\u00f6\u00dfe"}));
}

TEST_F(ChangedMachine, DeclaresThatALibraryIsStrictAndRefusesByNameWhatLibrariesCannotDeclare) {
  copy("count_down");
  write("show_SHOWAA/semantic_data.json", R"j({"segue": {"strict": "true"}})j");
  const auto machine = import();
  ASSERT_TRUE(machine) << to_string(diagnostics_);
  const auto library = std::ranges::find(machine->mission.states, StateKind::Library, &State::kind);
  EXPECT_TRUE(library->strict);
  write("show_SHOWAA/semantic_data.json", R"j({"segue": {"preconditions": "ready()"}})j");
  EXPECT_FALSE(import());
  EXPECT_THAT(to_string(diagnostics_), AllOf(HasSubstr("show_SHOWAA/semantic_data.json"),
                                             HasSubstr("a library cannot declare preconditions")));
}

TEST_F(ChangedMachine, HasPortsOfTypeTuple) {
  copy("interface");
  replace("asks_ASKSAA/core_data.json", "__builtin__.list", "__builtin__.tuple");
  const auto machine = import();
  ASSERT_TRUE(machine) << to_string(diagnostics_);
  EXPECT_TRUE(std::ranges::any_of(machine->mission.actions.front().inputs,
                                  [](const Port& port) { return port.type == "tuple"; }));
}

TEST_F(OwnMachine, LibrariesOfAnyNameAreFoundInAFolderWithoutOne) {
  EXPECT_TRUE(import_rafcon(kOurs / "count_down", {{"", kOurs / "libraries"}}, diagnostics_))
      << to_string(diagnostics_);
}

TEST_F(OwnMachine, AllFilesAreReadByWhoImports) {
  std::size_t files = 0;
  const auto count = [&](const std::filesystem::path& file) {
    auto text = read_file(file);
    files += text ? 1U : 0U;
    return text;
  };
  EXPECT_TRUE(import_rafcon(kOurs / "count_down", {{"own", kOurs / "libraries"}}, diagnostics_, count));
  EXPECT_EQ(files, 9U) << "3 + 2 + 1 of the machine and 3 of its library";
  const auto refuse = [](const std::filesystem::path& file) -> Result<std::string> {
    if (file.filename() == "script.py") return fail(ErrorCode::PermissionDenied, "not this one");
    return read_file(file);
  };
  EXPECT_FALSE(import_rafcon(kOurs / "count_down", {{"own", kOurs / "libraries"}}, diagnostics_, refuse));
  EXPECT_TRUE(diagnostics_.has_errors());
}

TEST_F(OwnMachine, HasScriptsThatCommandARobotWhereTheySaySo) {
  const auto folder =
      std::filesystem::path(::testing::TempDir()) / ("segue_scripts_" + std::to_string(::getpid()));
  std::filesystem::remove_all(folder);
  std::filesystem::copy(kOurs / "libraries", folder, std::filesystem::copy_options::recursive);
  ASSERT_TRUE(write_file(folder / "tools" / "show value" / "semantic_data.json",
                         R"j({"segue": {"controllers": "[go_to, 'look_at_{text}']"}})j"));
  const auto machine = import_rafcon(kOurs / "count_down", {{"own", folder}}, diagnostics_);
  ASSERT_TRUE(machine) << to_string(diagnostics_);
  const auto action = std::ranges::find_if(machine->mission.actions,
                                           [](const Action& each) { return each.controllers.has_value(); });
  ASSERT_NE(action, machine->mission.actions.end());
  EXPECT_EQ(*action->controllers, (std::vector<std::string>{"go_to", "look_at_{text}"}));
  EXPECT_TRUE(std::holds_alternative<Script>(action->run)) << "the script is its own";
  EXPECT_TRUE(validate(machine->mission).empty()) << to_string(validate(machine->mission));
  std::filesystem::remove_all(folder);
}

TEST_F(OwnMachine, UsesAControllerWhereALibraryStateSaysSo) {
  const auto folder =
      std::filesystem::path(::testing::TempDir()) / ("segue_controls_" + std::to_string(::getpid()));
  std::filesystem::remove_all(folder);
  std::filesystem::copy(kOurs / "libraries", folder, std::filesystem::copy_options::recursive);
  ASSERT_TRUE(write_file(folder / "tools" / "show value" / "semantic_data.json", R"j({"segue": {"run": {
      "controller": "go_to", "afterwards": "stop",
      "call": {"seeker.set_goal": {"goal": "{value}"}, "seeker.say": "{text: '{text}'}"},
      "until": "[{task: seeker, state: arrived}, {after: 2min, outcome: aborted}]"}}})j"));
  const auto machine = import_rafcon(kOurs / "count_down", {{"own", folder}}, diagnostics_);
  ASSERT_TRUE(machine) << to_string(diagnostics_);
  const auto action = std::ranges::find_if(machine->mission.actions, [](const Action& each) {
    return std::holds_alternative<ControllerUse>(each.run);
  });
  ASSERT_NE(action, machine->mission.actions.end());
  const auto& use = std::get<ControllerUse>(action->run);
  EXPECT_EQ(use.controller, "go_to");
  EXPECT_TRUE(use.stop);
  ASSERT_EQ(use.call.size(), 2U);
  EXPECT_EQ(use.call[0].value, type::Value::map({{"goal", "{value}"}}));
  EXPECT_EQ(use.call[1].value, type::Value::map({{"text", "{text}"}}));
  EXPECT_EQ(use.until.size(), 2U);
  EXPECT_TRUE(validate(machine->mission).empty()) << to_string(validate(machine->mission));
  std::filesystem::remove_all(folder);
}

TEST_F(OwnMachine, DeclaresWhatAContainerNeeds) {
  const auto folder =
      std::filesystem::path(::testing::TempDir()) / ("segue_contains_" + std::to_string(::getpid()));
  std::filesystem::remove_all(folder);
  std::filesystem::copy(kOurs / "race", folder, std::filesystem::copy_options::recursive);
  ASSERT_TRUE(write_file(folder / "both_BOTHAA" / "semantic_data.json", R"j({"segue": {
      "preconditions": "!dark", "resources": "[{block: arm}]", "strict": "true"}})j"));
  const auto machine = import_rafcon(folder, {}, diagnostics_);
  ASSERT_TRUE(machine) << to_string(diagnostics_);
  const auto both =
      std::ranges::find_if(machine->mission.states, [](const State& each) { return each.strict; });
  ASSERT_NE(both, machine->mission.states.end());
  EXPECT_TRUE(is_container(both->kind));
  EXPECT_EQ(both->preconditions.size(), 1U);
  EXPECT_EQ(both->resources.at(0).resource, "arm");
  std::filesystem::remove_all(folder);
}

TEST_F(OwnMachine, OfTheOldFormatIsRead) {
  const auto machine = import("side_by_side");
  ASSERT_TRUE(machine) << to_string(diagnostics_);
  EXPECT_EQ(told(machine->counts), told({8, 0, 10, 0}));
  EXPECT_TRUE(validate(machine->mission).empty()) << to_string(validate(machine->mission));
}

TEST_F(OwnMachine, WithGapsInItsOutcomesSaysWhatThatMeansForTheScript) {
  const auto machine = import("renumbered");
  ASSERT_TRUE(machine) << to_string(diagnostics_);
  EXPECT_THAT(to_string(diagnostics_), HasSubstr("its script must return them by name [outcome-numbers]"));
  EXPECT_EQ(machine->mission.actions.front().outcomes, (std::vector<std::string>{"gone", "there"}));
}

TEST_F(OwnMachine, WithUnconnectedOutcomesAndWrongTypesRunsAndSaysSo) {
  const auto machine = import("unfinished");
  ASSERT_TRUE(machine) << to_string(diagnostics_);
  EXPECT_THAT(
      to_string(diagnostics_),
      AllOf(HasSubstr("warning: the outcome 'bad' of 'asks' has no transition: 'unfinished' aborts if it is "
                      "reached [unconnected-outcome]"),
            HasSubstr("warning: 'way' of 'asks' is of type int, but gets values of other types: it takes any "
                      "value [type-mismatch]")));
  EXPECT_TRUE(validate(machine->mission).empty()) << to_string(validate(machine->mission));
  EXPECT_EQ(machine->mission.actions.front().inputs.front().type, "any");
}

TEST_F(OwnMachine, WithAMissingLibraryIsRefused) {
  EXPECT_FALSE(import_rafcon(kOurs / "count_down", {}, diagnostics_));
  EXPECT_THAT(to_string(diagnostics_), HasSubstr("there is no library 'own/tools/show value'"));
}

TEST_F(OwnMachine, ThatIsNotThereIsRefused) {
  EXPECT_FALSE(import("nothing"));
  EXPECT_THAT(to_string(diagnostics_), HasSubstr("unreadable-file"));
}

}  // namespace
}  // namespace segue::mission
