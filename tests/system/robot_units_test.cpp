// SPDX-License-Identifier: Apache-2.0
// Units of a robot that outlive the runs of its missions, a mission that is killed, and the runtime.
#include <gmock/gmock.h>

#include <fstream>
#include <iterator>
#include <string>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::HasSubstr;

/// Puts boxes on the deck of the robot, drives, and takes one from it again.
constexpr const char* kDeliver = R"(mission: deliver
resources: {box: {class: world, of: robot}}
actions:
  load: {resources: [{create: box, count: 3}], run: {simulated: {}}}
  drive:
    run:
      controller: go_to
      call: {seeker.set_goal: {goal: {x: 0.4, y: 0.0}}}
      until: [{task: seeker, state: arrived}]
  unload: {resources: [{delete: box}], run: {simulated: {}}}
outcomes: [done, empty]
start: load
states:
  load: {on: {success: drive}}
  drive: {on: {success: unload, aborted: unload}}
  unload: {on: {success: return done, aborted: return empty}}
at_end: keep
)";

/// As above, but the drive never ends.
std::string endless() {
  std::string text = kDeliver;
  const std::string near = "x: 0.4";
  text.replace(text.find(near), near.size(), "x: 1000.0");
  return text;
}

class RobotUnits : public SystemTest {
 protected:
  void start_with_units() {
    if (!std::filesystem::exists(folder_ / "rover")) {
      ASSERT_EQ(segue({"init", "rover"}).status, 0);
      std::ofstream(folder_ / "rover/robot.yaml", std::ios::app) << "units: {box: 2, screws: {count: 40}}\n";
    }
    start();
  }
  [[nodiscard]] std::int64_t count_of(const std::string& name) {
    const auto units = json({"units"});
    for (const type::Value& one : units.find("units")->as_list()) {
      if (*one.find("name") == type::Value(name)) return one.find("count")->as_int();
    }
    ADD_FAILURE() << "there are no units " << name;
    return -1;
  }
  [[nodiscard]] std::string journal() const {
    std::ifstream file(folder_ / "journal");
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

TEST_F(RobotUnits, AreLeftToTheNextMission) {
  start_with_units();
  write("deliver.yaml", kDeliver);
  std::int64_t expected = 2;
  for (const std::string mode : {"sequential", "concurrent"}) {
    SCOPED_TRACE(mode);
    const auto run = json({"mission", "run", "deliver.yaml", "--mode", mode});
    EXPECT_EQ(run.find("outcome")->as_string(), "done") << type::to_json(run);
    expected += 2;
    EXPECT_EQ(run.find("units")->find("box")->as_int(), expected);
    EXPECT_EQ(count_of("box"), expected);
  }
  EXPECT_EQ(count_of("screws"), 40);
  EXPECT_EQ(stop().status, 0);
  start_with_units();
  EXPECT_EQ(count_of("box"), expected) << "with the next runtime";
}

TEST_F(RobotUnits, AreCorrectedWhileNoMissionCommandsTheRobot) {
  start_with_units();
  EXPECT_THAT(segue({"units", "set", "screws", "12"}).output, HasSubstr("screws: 12 (was 40)"));
  EXPECT_EQ(json({"units", "set", "screws", "13"}).find("before")->as_int(), 12);
  EXPECT_EQ(count_of("screws"), 13);
  EXPECT_THAT(segue({"events"}).output, HasSubstr("set it from 12 to 13"));
  EXPECT_THAT(segue({"units"}).output, HasSubstr("screws     13\n"));
  EXPECT_EQ(segue({"complete-names", "units"}).output, "box\nscrews\n");
  const auto unknown = segue({"units", "set", "screw", "1"});
  EXPECT_EQ(unknown.status, 1);
  EXPECT_THAT(unknown.errors, HasSubstr("did you mean 'screws'"));
  EXPECT_EQ(segue({"units", "set", "screws", "-1"}).status, 2);

  write("endless.yaml", endless());
  Process mission(command({"mission", "run", "endless.yaml"}), folder_);
  EXPECT_TRUE(eventually([&] { return count_of("box") == 5; })) << "while it goes on";
  const auto refused = segue({"units", "set", "screws", "1"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.errors, HasSubstr("the robot is commanded by segue mission run"));
  mission.signal(SIGINT);
  mission.wait();
  EXPECT_EQ(count_of("screws"), 13);
  EXPECT_EQ(count_of("box"), 5);
}

/// Of which the robot has heard, or hardly, when the mission is killed after the end of its action.
TEST_F(RobotUnits, CountOnceThoughTheMissionIsKilledAndResumed) {
  start_with_units();
  write("endless.yaml", endless());
  for (const std::string mode : {"sequential", "concurrent"}) {
    for (const bool has_heard : {false, true}) {
      SCOPED_TRACE(mode + (has_heard ? ", heard" : ""));
      const std::int64_t before = count_of("box");
      std::vector<std::string> line = {"mission", "run",       "endless.yaml", "--mode",
                                       mode,      "--journal", "journal"};
      Process mission(command(line), folder_);
      EXPECT_TRUE(eventually([&] {
        const std::string text = journal();
        return text.find(R"("ended":"load")") != text.npos && text.find(R"("begun":"drive")") != text.npos;
      }));
      EXPECT_TRUE(eventually([&] { return !has_heard || count_of("box") == before + 3; }));
      mission.signal(SIGKILL);
      mission.wait();
      line.insert(line.end(), {"--resume", "--under-way", "abort"});
      Finished resumed;
      EXPECT_TRUE(eventually([&] {  // until the robot knows that whoever commanded it is gone
        resumed = segue(line);
        return resumed.errors.find("commanded by") == std::string::npos;
      }));
      EXPECT_EQ(resumed.status, 0) << resumed.output << resumed.errors;
      EXPECT_EQ(count_of("box"), before + 2) << "three were loaded, and one unloaded";
      std::filesystem::remove(folder_ / "journal");
    }
  }
}

TEST_F(RobotUnits, OutliveARuntimeThatIsKilled) {
  start_with_units();
  write("endless.yaml", endless());
  Process mission(command({"mission", "run", "endless.yaml", "--journal", "journal"}), folder_);
  EXPECT_TRUE(eventually([&] { return count_of("box") == 5; }));
  robot_->signal(SIGKILL);
  robot_->wait();
  EXPECT_EQ(mission.wait().status, 1);
  start_with_units();
  EXPECT_EQ(count_of("box"), 5);
  ASSERT_EQ(segue({"units", "set", "box", "9"}).status, 0);
  const std::vector<std::string> resume = {"mission", "run",      "endless.yaml", "--journal",
                                           "journal", "--resume", "--under-way",  "abort"};
  const auto refused = segue(resume);
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.errors, HasSubstr("there are 9 units of the resource 'box' now, and would be 5"));
  ASSERT_EQ(segue({"units", "set", "box", "5"}).status, 0);
  EXPECT_EQ(segue(resume).status, 0);
  EXPECT_EQ(count_of("box"), 4) << "what the robot had heard does not count again";
}

TEST_F(RobotUnits, OfAMissionAreThoseOfItsRobotFile) {
  start_with_units();
  std::string other = kDeliver;
  for (auto at = other.find("box"); at != std::string::npos; at = other.find("box", at))
    other.replace(at, 3, "bolt");
  write("rover/deliver.yaml", other);
  const auto run = segue({"mission", "run", "rover/deliver.yaml"});
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.errors, HasSubstr("the robot keeps no units 'bolt'"));
  const auto simulated = segue({"mission", "run", "rover/deliver.yaml", "--simulate", "--clock", "virtual"});
  EXPECT_EQ(simulated.status, 1);
  EXPECT_THAT(simulated.errors, HasSubstr("--resource bolt=3"));
  EXPECT_EQ(segue({"mission", "run", "rover/deliver.yaml", "--simulate", "--clock", "virtual", "--resource",
                   "bolt=3"})
                .status,
            0);
}

}  // namespace
}  // namespace segue::testing
