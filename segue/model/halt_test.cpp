// SPDX-License-Identifier: Apache-2.0
#include <segue/model/files.hpp>
#include <segue/model/robot.hpp>
#include <segue/model/validate.hpp>

#include <support/network_of.hpp>

#include <gmock/gmock.h>

#include <string>
#include <vector>

namespace segue::model {
namespace {

using segue::testing::network_of;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::optional<Robot> robot_with(const std::string& halt, Diagnostics& diagnostics) {
  return read_robot_parts("robot: r\nhalt: " + halt + "\n", "robot.yaml", diagnostics);
}

std::string problem_of(const std::string& halt) {
  Diagnostics diagnostics;
  (void)robot_with(halt, diagnostics);
  return diagnostics.items().empty() ? "" : diagnostics.items().front().message;
}

std::vector<std::string> problems_together(const std::string& halt, const ComponentCatalog& catalog = {}) {
  Diagnostics diagnostics;
  const auto robot = robot_with(halt, diagnostics);
  const std::vector<Network> networks = {
      network_of("network: hold\ntasks: {arm: {component: \"x::Arm\"}}\n"),
      network_of("network: guard\ntasks: {button: {component: \"x::Button\"}}\n")};
  diagnostics.append(validate(*robot, networks));
  check_halt_members(*robot, networks, catalog, diagnostics);
  std::vector<std::string> messages;
  for (const auto& item : diagnostics.items())
    messages.push_back(item.message);
  return messages;
}

TEST(Halt, SaysWhatRestIs) {
  Diagnostics diagnostics;
  const auto robot = robot_with(
      "{controller: hold+guard, at_rest: [{task: arm, state: holding}, {port: arm.speed, where: value < "
      "0.1}], "
      "within: 500ms, when: [{call: button.is_pressed, is: true}]}",
      diagnostics);
  ASSERT_TRUE(robot && robot->halt) << to_string(diagnostics);
  EXPECT_THAT(diagnostics.items(), IsEmpty());
  EXPECT_EQ(robot->halt->controller, NetworkName("guard+hold"));
  ASSERT_EQ(robot->halt->at_rest.size(), 2U);
  EXPECT_EQ(sentence(robot->halt->at_rest[0].condition), "task 'arm' is holding");
  EXPECT_EQ(sentence(robot->halt->at_rest[1].condition), "a sample of arm.speed showed value < 0.1");
  EXPECT_EQ(robot->halt->within, std::chrono::milliseconds(500));
  EXPECT_EQ(sentence(robot->halt->when.at(0).condition), "button.is_pressed answered true");
}

TEST(Halt, DefaultsToTwoSeconds) {
  Diagnostics diagnostics;
  EXPECT_EQ(robot_with("{controller: hold}", diagnostics)->halt->within, std::chrono::seconds(2));
}

TEST(Halt, MistakesInItAreFound) {
  EXPECT_THAT(problem_of("{within: 1s}"), HasSubstr("controller"));
  EXPECT_THAT(problem_of("{controller: hold, within: 0s}"), HasSubstr("longer than nothing"));
  EXPECT_THAT(problem_of("{controller: hold, at_rest: [{task: arm}]}"), HasSubstr("state"));
  EXPECT_THAT(problem_of("{controller: hold, at_rest: [{after: 1s}]}"), HasSubstr("after"));
  EXPECT_THAT(problem_of("{controller: hold, when: [{}]}"), HasSubstr("expected exactly one of"));
  EXPECT_THAT(problem_of("{controller: hold, if: []}"), HasSubstr("if"));
  EXPECT_THAT(problem_of("{controller: ../hold}"), HasSubstr("hold"));
}

TEST(Halt, NamesControllersAndTasksThatThereAre) {
  EXPECT_THAT(problems_together("{controller: hold+guard, at_rest: [{task: button, state: released}]}"),
              IsEmpty());
  EXPECT_THAT(problems_together("{controller: hlod}").at(0), HasSubstr("did you mean 'hold'"));
  EXPECT_THAT(problems_together("{controller: hold, at_rest: [{task: button, state: released}]}").at(0),
              HasSubstr("controller 'hold' has no task 'button'"));
  EXPECT_THAT(problems_together("{controller: hold, when: [{task: buton, state: pressed}]}").at(0),
              HasSubstr("no controller has a task 'buton', did you mean 'button'?"));
}

TEST(Halt, AsksComponentsForWhatTheyHave) {
  ComponentCatalog catalog;
  ComponentModel arm;
  arm.name = ComponentName("x::Arm");
  arm.nominal_states = {"moving", "holding"};
  catalog.add(arm);
  EXPECT_THAT(problems_together("{controller: hold, at_rest: [{task: arm, state: holding}]}", catalog),
              IsEmpty());
  EXPECT_THAT(problems_together("{controller: hold, at_rest: [{task: arm, state: hodling}]}", catalog).at(0),
              HasSubstr("has no state 'hodling', did you mean 'holding'?"));
  EXPECT_THAT(problems_together("{controller: hold, when: [{call: arm.is_hot, is: true}]}", catalog).at(0),
              HasSubstr("has no operation 'is_hot'"));
}

}  // namespace
}  // namespace segue::model
