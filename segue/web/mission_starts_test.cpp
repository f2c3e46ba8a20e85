// SPDX-License-Identifier: Apache-2.0
#include <segue/web/file_verbs_test_support.hpp>
#include <segue/web/mission_starts.hpp>

#include <gmock/gmock.h>

#include <string>
#include <vector>

namespace segue::web {
namespace {

using ::testing::HasSubstr;
using type::Value;

constexpr std::string_view kFetch = R"(mission: fetch
description: Fetches something.
inputs:
  what: {type: text, default: cup}
  count: int
  limits: list
  speed: {type: float, default: 0.5}
start: return success
states: {}
)";

class MissionStartsTest : public RobotFilesTest {
 protected:
  MissionStartsTest()
      : RobotFilesTest({}, [this](const MissionOrder& order, TimePoint /*deadline*/) {
          orders_.push_back(order);
          return answer_;
        }) {}

  void SetUp() override {
    RobotFilesTest::SetUp();
    write("robot.yaml", "robot: fake\n");
    write("fetch.yaml", kFetch);
  }
  static Value asked(Value inputs, type::ValueMap more = {}) {
    type::ValueMap arguments = std::move(more);
    arguments.set("path", "fetch.yaml");
    arguments.set("inputs", std::move(inputs));
    return Value(std::move(arguments));
  }

  std::vector<MissionOrder> orders_;
  Result<Value> answer_{Value()};
};

TEST_F(MissionStartsTest, AFormHasTheInputsOfTheMission) {
  const Value form = result("mission_form", Value::map({{"path", "fetch.yaml"}}), Role::Observe);
  EXPECT_EQ(
      form,
      Value::map(
          {{"mission", "fetch"},
           {"description", "Fetches something."},
           {"inputs", Value::list({Value::map({{"name", "what"}, {"type", "text"}, {"default", "cup"}}),
                                   Value::map({{"name", "count"}, {"type", "int"}, {"default", Value()}}),
                                   Value::map({{"name", "limits"}, {"type", "list"}, {"default", Value()}}),
                                   Value::map({{"name", "speed"}, {"type", "float"}, {"default", 0.5}})})},
           {"needs_robot", false}}));
}

TEST_F(MissionStartsTest, PythonNeedsAnAdministrator) {
  write("fetch.yaml",
        "mission: fetch\nactions: {look: {run: {python: {text: 'def execute(self, inputs, outputs, gvm): "
        "return 0'}}}}\n"
        "start: look\nstates: {look: {action: look, on: {success: return success}}}\n");
  EXPECT_EQ(error("start_mission", asked(Value::map({}))), "permission-denied");
  EXPECT_TRUE(orders_.empty());
  EXPECT_EQ(result("start_mission", asked(Value::map({})), Role::Administer), Value::map({{"run", Value()}}));
}

TEST_F(MissionStartsTest, AMissionIsStartedWithTheValuesOfItsInputs) {
  const Value inputs = Value::map({{"what", "a: b"}, {"count", "3"}, {"limits", "[1, two]"}, {"speed", "2"}});
  type::ValueMap how;
  how.set("mode", "strict");
  EXPECT_EQ(result("start_mission", asked(inputs, how)), Value::map({{"run", Value()}}));
  ASSERT_EQ(orders_.size(), 1U);
  EXPECT_EQ(orders_[0].file, home_ / "fetch.yaml");
  EXPECT_EQ(Value(orders_[0].inputs),
            Value::map({{"what", "a: b"}, {"count", 3}, {"limits", Value::list({1, "two"})}, {"speed", 2}}));
  EXPECT_EQ(orders_[0].mode, MissionMode::Strict);
  EXPECT_FALSE(orders_[0].simulate || orders_[0].steps_back);
  EXPECT_EQ(orders_[0].who, "somebody");
  how.set("mode", "sequential");
  how.set("simulate", true);
  how.set("steps_back", true);
  answer_ = Value::map({{"nodes", Value::List()}});
  EXPECT_EQ(result("start_mission", asked(Value::map({}), how)), Value::map({{"run", *answer_}}));
  EXPECT_TRUE(orders_[1].simulate && orders_[1].steps_back);
  EXPECT_TRUE(orders_[1].inputs.empty()) << "defaults count";
}

TEST_F(MissionStartsTest, AnInputThatDoesNotTakeItsTextIsNamed) {
  const Value inputs = Value::map({{"count", "many"}, {"limits", "[1"}, {"speed", "0.5"}, {"colour", "red"}});
  const Value answer = result("start_mission", asked(inputs));
  const auto& problems = answer.find("problems")->as_map();
  ASSERT_EQ(problems.size(), 3U) << type::to_json(answer);
  EXPECT_EQ(problems.find("count")->as_string(), "this input is of type int, not 'many'");
  EXPECT_THAT(problems.find("limits")->as_string(), HasSubstr("this is not YAML: "));
  EXPECT_EQ(problems.find("colour")->as_string(), "the mission has no such input");
  EXPECT_TRUE(orders_.empty());
}

TEST_F(MissionStartsTest, WhatCannotBeStartedIsRefused) {
  write("bad.yaml", "mission: bad\nstart: nowhere\nstates: {}\n");
  write("../outside.yaml", kFetch);
  for (const auto& [path, code] :
       {std::pair("bad.yaml", "invalid-argument"), std::pair("robot.yaml", "invalid-argument"),
        std::pair("../outside.yaml", "not-found"), std::pair("gone.yaml", "not-found")}) {
    EXPECT_EQ(error("mission_form", Value::map({{"path", path}})), code) << path;
    EXPECT_EQ(error("start_mission", Value::map({{"path", path}})), code) << path;
  }
  type::ValueMap how;
  how.set("mode", "fast");
  EXPECT_EQ(error("start_mission", asked(Value::map({}), how)), "invalid-argument");
  EXPECT_EQ(error("start_mission", asked(Value("count: 3"))), "invalid-argument");
  EXPECT_EQ(error("start_mission", asked(Value::map({{"count", 3}}))), "invalid-argument") << "no text";
  EXPECT_EQ(error("start_mission", asked(Value::map({})), Role::Observe), "permission-denied");
  EXPECT_TRUE(orders_.empty());
  answer_ = fail(ErrorCode::InvalidState, "somebody else commands the robot");
  EXPECT_EQ(error("start_mission", asked(Value::map({}))), "invalid-state");
}

class StartsNone : public RobotFilesTest {
 protected:
  StartsNone() : RobotFilesTest({}) {}
};

TEST_F(StartsNone, AStudioWithoutARunnerSaysSo) {
  EXPECT_EQ(error("start_mission", Value::map({{"path", "fetch.yaml"}})), "unsupported");
}

}  // namespace
}  // namespace segue::web
