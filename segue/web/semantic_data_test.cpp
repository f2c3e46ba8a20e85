// SPDX-License-Identifier: Apache-2.0
#include <segue/web/file_verbs_test_support.hpp>

#include <support/paths.hpp>

#include <map>

namespace segue::web {
namespace {

namespace fs = std::filesystem;
using type::Value;

const std::string kMachine = "machines/count_down";
const std::string kStep = "step down_STEPAA";

/// A robot with a copy of a machine of RAFCON and its library.
class SemanticDataTest : public RobotFilesTest {
 protected:
  SemanticDataTest() : RobotFilesTest({}) {}

  void SetUp() override {
    RobotFilesTest::SetUp();
    write("robot.yaml", "robot: fake\ncontrollers: []\n");
    fs::create_directories(home_ / "machines");
    for (const char* name : {"count_down", "libraries"}) {
      fs::copy(segue::paths::in_sources("/tests/rafcon") + "/" + name,
               home_ / (name == std::string("libraries") ? "own" : kMachine), fs::copy_options::recursive);
    }
  }

  static Value named(const std::string& state) { return Value::map({{"path", kMachine}, {"state", state}}); }
  std::string version_of(const std::string& state) {
    return result("semantic_data", named(state), Role::Observe).find("version")->as_string();
  }
  static Value edit(std::initializer_list<Value> keys, const Value& value) {
    return Value::map({{"keys", Value::list(keys)}, {"value", value}});
  }
  Value edits(const std::string& state, std::initializer_list<Value> list) {
    Value arguments = named(state);
    arguments.as_map().set("version", version_of(state));
    arguments.as_map().set("edits", Value::list(list));
    return arguments;
  }
  std::vector<std::string> problems(const Value& arguments) {
    std::vector<std::string> found;
    const Value answer = result("check_semantic_data", arguments, Role::Observe);
    for (const Value& one : answer.find("problems")->as_list())
      found.push_back(one.find("message")->as_string());
    return found;
  }
  /// The texts of all files of the robot.
  std::map<std::string, std::string> texts() {
    std::map<std::string, std::string> found;
    for (const auto& entry : fs::recursive_directory_iterator(home_)) {
      if (entry.is_regular_file())
        found[entry.path().lexically_relative(home_).string()] = read_file(entry.path()).value_or("");
    }
    return found;
  }
};

TEST_F(SemanticDataTest, StatesOfAMachineSayTheirFolders) {
  const Value file = result("read_file", Value::map({{"path", kMachine}}), Role::Observe);
  EXPECT_EQ(*file.find("folders"),
            Value::map({{"", ""}, {"show", "show_SHOWAA"}, {"step_down", "step down_STEPAA"}}));
}

TEST_F(SemanticDataTest, WhatIsEditedIsAllThatChanges) {
  auto expected = texts();
  const std::string original = expected[kMachine + "/" + kStep + "/semantic_data.json"];
  std::string& step = expected[kMachine + "/" + kStep + "/semantic_data.json"];
  const Value before = result("semantic_data", named(kStep), Role::Observe);
  EXPECT_NE(before.find("data")->find("resources"), nullptr) << type::to_json(before);
  const auto end = step.rfind("\n}");
  ASSERT_NE(end, std::string::npos);
  step.insert(end, ",\n    \"segue\": {\n        \"effects\": \"[\\\"+counted()\\\"]\"\n    }");
  const Value saved =
      result("save_semantic_data", edits(kStep, {edit({"segue", "effects"}, "[\"+counted()\"]")}));
  EXPECT_EQ(*saved.find("version"), Value(version_of(kStep)));
  result("save_semantic_data", edits("", {edit({"by"}, "me")}));
  expected[kMachine + "/semantic_data.json"] = "{\n    \"by\": \"me\"\n}";
  EXPECT_EQ(texts(), expected);
  const Value mission = result("read_file", Value::map({{"path", kMachine}}), Role::Observe);
  EXPECT_NE(mission.find("text")->as_string().find("+counted"), std::string::npos);
  const Value gone = Value::map({{"keys", Value::list({"segue"})}});
  result("save_semantic_data", edits(kStep, {gone}));
  EXPECT_EQ(content(kMachine + "/" + kStep + "/semantic_data.json"), original);
}

TEST_F(SemanticDataTest, WhatWouldBeWrongIsRefusedWithItsSubject) {
  const auto before = texts();
  const Value wrong = edits(kStep, {edit({"segue", "effect"}, "[\"+counted()\"]")});
  const auto found = problems(wrong);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NE(found[0].find("'segue' in the semantic data of 'step down'"), std::string::npos) << found[0];
  EXPECT_NE(found[0].find("'effects'"), std::string::npos) << found[0];
  const std::string answer = type::to_json(ask("save_semantic_data", wrong), -1);
  EXPECT_NE(answer.find("\"invalid-argument\""), std::string::npos) << answer;
  EXPECT_NE(answer.find("'segue' in the semantic data of 'step down'"), std::string::npos) << answer;
  EXPECT_EQ(problems(edits(kStep, {edit({"segue", "resources"}, "[{block: arm, count: 2}]")})).size(), 1U)
      << "the machine has one arm";
  EXPECT_EQ(texts(), before);
}

TEST_F(SemanticDataTest, ProblemsThatTheMachineHasAlreadyRefuseNothing) {
  result("save_semantic_data", edits("", {edit({"segue", "resources"}, "{arm: {count: 2}}")}));
  result("save_semantic_data", edits(kStep, {edit({"segue", "resources"}, "[{block: arm, count: 2}]")}));
  write(kMachine + "/semantic_data.json", "{}");
  EXPECT_EQ(problems(edits(kStep, {edit({"note"}, "x")})), std::vector<std::string>{});
}

TEST_F(SemanticDataTest, SomebodyElsesChangeIsNotWrittenOver) {
  Value mine = edits(kStep, {edit({"a"}, "mine")});
  Value fresh = edits("", {edit({"a"}, "mine")});
  write(kMachine + "/" + kStep + "/semantic_data.json", "{\"a\": \"theirs\"}");
  write(kMachine + "/semantic_data.json", "{}");
  const auto before = texts();
  EXPECT_EQ(error("save_semantic_data", mine), "invalid-state");
  EXPECT_EQ(error("check_semantic_data", mine), "invalid-state");
  EXPECT_EQ(error("save_semantic_data", fresh), "invalid-state") << "there was no file yet";
  EXPECT_EQ(texts(), before);
}

TEST_F(SemanticDataTest, NothingButStatesOfMachinesCanBeNamedAndNothingThroughLinks) {
  write("mission.yaml", "mission: m\nstates: {}\n");
  write("../outside.json", "{\"secret\": 1}");
  fs::copy(home_ / kMachine / kStep, folder_ / "state", fs::copy_options::recursive);
  fs::create_directory_symlink(folder_ / "state", home_ / kMachine / "linked_LINKED");
  const auto with = [](const std::string& path, const std::string& state) {
    return Value::map({{"path", path}, {"state", state}});
  };
  EXPECT_EQ(error("semantic_data", with(kMachine, "linked_LINKED")), "permission-denied");
  EXPECT_EQ(error("semantic_data", with("machines", "count_down")), "not-found");
  EXPECT_EQ(error("semantic_data", with("mission.yaml", "")), "unsupported");
  EXPECT_EQ(error("semantic_data", with(kMachine, "nothing")), "not-found");
  for (const char* state : {"../count_down", "..", ".", "/etc", "step down_STEPAA/", "show_SHOWAA/../"})
    EXPECT_EQ(error("semantic_data", with(kMachine, state)), "invalid-argument") << state;
  const fs::path file = home_ / kMachine / kStep / "semantic_data.json";
  fs::remove(file);
  fs::create_symlink(folder_ / "outside.json", file);
  EXPECT_EQ(error("semantic_data", named(kStep)), "permission-denied");
  Value arguments = named(kStep);
  arguments.as_map().set("version", "");
  arguments.as_map().set("edits", Value::list({edit({"a"}, "x")}));
  EXPECT_EQ(error("save_semantic_data", arguments), "permission-denied");
  EXPECT_EQ(read_file(folder_ / "outside.json").value(), "{\"secret\": 1}");
}

TEST_F(SemanticDataTest, EditsHaveKeysAndAnObserverMakesNone) {
  const Value good = edits(kStep, {edit({"a"}, "x")});
  EXPECT_EQ(error("save_semantic_data", good, Role::Observe), "permission-denied");
  EXPECT_EQ(problems(good), std::vector<std::string>{}) << "it may look whether they are right";
  for (const Value& wrong :
       {Value("x"), Value::list({Value("x")}), Value::list({Value::map({{"keys", "a"}})}),
        Value::list({Value::map({{"keys", Value::list({1})}})}),
        Value::list({Value::map({{"keys", Value::list({})}, {"value", 1}})})}) {
    Value arguments = good;
    arguments.as_map().set("edits", wrong);
    EXPECT_EQ(error("save_semantic_data", arguments), "invalid-argument") << type::to_json(wrong, -1);
  }
}

}  // namespace
}  // namespace segue::web
