// SPDX-License-Identifier: Apache-2.0
//
// A mission that is stepped from other terminals, through the robot that it commands.
#include <gmock/gmock.h>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::HasSubstr;

constexpr const char* kNested = R"(mission: nested
actions:
  look: {outputs: {found: int}, run: {simulated: {duration: 10ms, outputs: {found: 7}}}}
  take: {inputs: {what: int}, run: {simulated: {duration: 10ms}}}
start: fetch
states:
  fetch:
    start: look
    flows: [look.found -> take.what]
    states:
      look: {on: {success: take}}
      take: {on: {success: return success}}
    on: {success: again}
  again: {action: look, on: {success: return success}}
)";

class MissionSteps : public SystemTest {
 protected:
  std::unique_ptr<Process> mission(std::vector<std::string> more) {
    write("nested.yaml", kNested);
    std::vector<std::string> arguments = {"mission", "run", "nested.yaml"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return std::make_unique<Process>(command(std::move(arguments)), folder_);
  }
  /// Waits until `segue mission status` says that.
  void wait_for_status(const std::string& what) {
    std::string seen;
    ASSERT_TRUE(eventually([&] {
      seen = segue({"mission", "status"}).output;
      return seen.find(what) != std::string::npos;
    })) << seen;
  }
};

TEST_F(MissionSteps, AreTakenFromOtherTerminals) {
  start();
  EXPECT_THAT(segue({"mission", "step"}).errors, HasSubstr("no mission commands the robot"));
  const auto run = mission({"--break", "fetch", "--steps-back"});
  wait_for_status("mission nested: paused; held before fetch; 0 actions have ended\nbreakpoints: fetch\n");
  EXPECT_EQ(segue({"mission", "break", "again"}).output, "fetch\nagain\n");
  EXPECT_EQ(segue({"mission", "break", "--clear", "fetch"}).output, "again\n");
  const auto unknown = segue({"mission", "break", "nowhere"});
  EXPECT_EQ(unknown.status, 1);
  EXPECT_THAT(unknown.errors, HasSubstr("there is no state 'nowhere'"));
  EXPECT_EQ(segue({"mission", "break"}).output, "again\n") << "those set before remain";

  EXPECT_EQ(segue({"mission", "step", "into"}).output, "mission nested: held before fetch/look\n");
  EXPECT_EQ(segue({"mission", "step"}).output, "mission nested: held before fetch/take\n");
  const auto values = segue({"mission", "values", "fetch/take"});
  EXPECT_THAT(values.output, HasSubstr("fetch/take: would begin now with\n"));
  EXPECT_THAT(values.output, ::testing::ContainsRegex("input +what +int +7"));
  EXPECT_EQ(*json({"mission", "values", "fetch/take"}).find("when"), type::Value("next"));
  EXPECT_EQ(segue({"mission", "step", "back"}).output, "mission nested: held before fetch/look\n");
  EXPECT_EQ(segue({"mission", "step", "out"}).output, "mission nested: held before again\n");
  EXPECT_EQ(segue({"mission", "go-on-at", "fetch"}).output, "mission nested: held before fetch\n");
  EXPECT_EQ(segue({"mission", "go-on-at", "nowhere"}).status, 1);

  EXPECT_EQ(segue({"mission", "break", "--clear"}).output, "");
  EXPECT_EQ(segue({"mission", "resume"}).status, 0);
  const auto finished = run->wait();
  EXPECT_EQ(finished.status, 0) << finished.errors;
  EXPECT_THAT(finished.output, HasSubstr("nested: success"));
  EXPECT_THAT(finished.errors, HasSubstr("held before fetch/take; it goes on with 'segue mission step'"));
}

TEST_F(MissionSteps, EndWithTheMission) {
  start();
  const auto run = mission({"--break", "again"});
  wait_for_status("held before again");
  const auto back = segue({"mission", "step", "back"});
  EXPECT_EQ(back.status, 1);
  EXPECT_EQ(segue({"mission", "step"}).output, "the mission has ended\n");
  EXPECT_EQ(run->wait().status, 0);
}

TEST_F(MissionSteps, AreForMissionsThatRunAsWritten) {
  start();
  write("endless.yaml",
        "mission: endless\nactions: {a: {run: {simulated: {duration: 1h}}}}\nstart: a\n"
        "states: {a: {on: {success: return success}}}\n");
  const auto refused = segue({"mission", "run", "endless.yaml", "--break", "a", "--mode", "concurrent"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.errors, HasSubstr("for missions that run as they are written"));
  const auto misspelt = segue({"mission", "run", "endless.yaml", "--break", "b"});
  EXPECT_THAT(misspelt.errors, HasSubstr("there is no state 'b'; the mission has a"));
  EXPECT_THAT(misspelt.errors, Not(HasSubstr("at rest"))) << "the robot was not commanded";
  EXPECT_THAT(segue({"mission", "run", "endless.yaml", "--break", "a", "--clock", "virtual"}).errors,
              HasSubstr("virtual time"));

  Process run(command({"mission", "run", "endless.yaml", "--steps-back"}), folder_);
  wait_for_status("under way: a");
  const auto early = segue({"mission", "step"});
  EXPECT_EQ(early.status, 1);
  EXPECT_THAT(early.errors, HasSubstr("the mission is not held"));
  EXPECT_EQ(segue({"mission", "stop"}).status, 0);
  EXPECT_EQ(run.wait().status, 1);
}

}  // namespace
}  // namespace segue::testing
