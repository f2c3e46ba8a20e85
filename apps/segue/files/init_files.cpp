// SPDX-License-Identifier: Apache-2.0
#include "init_files.hpp"

#include <string_view>

namespace segue::cli {

namespace {

constexpr std::string_view kExplore = R"(# Wanders about and turns away from obstacles.
network: explore
tasks:
  drive: {component: "demo::Drive"}
  odometry: {component: "demo::Odometry"}
  laser: {component: "demo::LaserScanner"}
  wanderer: {component: "demo::Wanderer", properties: {speed: 0.4}}
connections:
  - drive.velocity -> odometry.velocity
  - odometry.pose -> laser.pose
  - laser.scan -> wanderer.scan
  - wanderer.command -> drive.command
)";

constexpr std::string_view kGoal =
    R"(# Drives to a goal. A switch from explore leaves drive, odometry and laser running.
network: go_to
tasks:
  drive: {component: "demo::Drive"}
  odometry: {component: "demo::Odometry"}
  laser: {component: "demo::LaserScanner"}
  guard: {component: "demo::ObstacleStop", properties: {distance: 0.3}}
  seeker: {component: "demo::GoalSeeker", properties: {goal: {x: 3.0, y: -2.0}}}
connections:
  - drive.velocity -> odometry.velocity
  - odometry.pose -> laser.pose
  - {from: odometry.pose, to: seeker.pose}
  - laser.scan -> guard.scan
  - {from: seeker.command, to: guard.command, policy: circular_buffer, size: 4}
  - guard.safe_command -> drive.command
)";

constexpr std::string_view kManual = R"(# Drives by hand: `segue call joystick.push forward=1 turn=0`.
network: manual
tasks:
  drive: {component: "demo::Drive"}
  odometry: {component: "demo::Odometry"}
  laser: {component: "demo::LaserScanner"}
  guard: {component: "demo::ObstacleStop"}
  joystick: {component: "demo::Joystick"}
connections:
  - drive.velocity -> odometry.velocity
  - odometry.pose -> laser.pose
  - laser.scan -> guard.scan
  - joystick.command -> guard.command
  - guard.safe_command -> drive.command
)";

constexpr std::string_view kReadme = R"(# @ROBOT@

A simulated robot in a square room, with three controllers: explore, go_to and manual; one in which it stands still: hold;
and a mission, visit. robot.yaml, controllers/hold.yaml and missions/visit.yaml explain all keys of such files.

In one terminal:

    segue check robot.yaml
    segue run robot.yaml --controller explore

In another:

    segue status
    segue read odometry.pose --follow
    segue switch go_to --dry-run        # what a switch would do
    segue switch go_to                  # drive, odometry and laser continue without missing a cycle
    segue set seeker.speed=0.2
    segue switch manual
    segue call joystick.push forward=1 turn=0.2
    segue mission run missions/visit.yaml
    segue top
    segue stop                          # bring it to rest, whoever commands it
    segue stop --release                # let it be commanded again

Ctrl-C in the first terminal brings the robot to rest and stops every task cleanly.

`controllers/` contains one file per controller. Add your own, and `segue check robot.yaml` reports any problems.
`segue component list` lists the available components, `segue component show demo::Drive` describes one of them.
)";

constexpr std::string_view kLibraryReadme = R"(
## Your own components

`components/` is a component library with one component:

    cmake -S components -B build && cmake --build build
    export SEGUE_LIBRARY_PATH=$PWD/build/lib/segue
    segue component list

Then add it to robot.yaml: `libraries: [segue_components_demo, @ROBOT@_components]`.
)";

constexpr std::string_view kCMake = R"(cmake_minimum_required(VERSION 3.25)
project(@ROBOT@_components LANGUAGES CXX)
find_package(segue REQUIRED)

segue_add_component_library(@ROBOT@_components SOURCES averager.cpp)
)";

constexpr std::string_view kComponent = R"(#include <segue/task/component.hpp>

namespace @NAMESPACE@ {

/// Smooths a number: the weighted mean of the input and the previous output.
class Averager final : public segue::task::Component {
 public:
  Averager() : Component({.doc = "Smooths a number", .trigger_on = {"input"}}) {}

 protected:
  void on_update() override {
    double value = 0;
    while (input_.read(value) == segue::task::ReadStatus::NewData) {
      mean_ += *weight_ * (value - mean_);
      output_.write(mean_);
    }
  }

 private:
  segue::task::InputPort<double> input_{*this, "input"};
  segue::task::OutputPort<double> output_{*this, "output"};
  segue::task::Property<double> weight_{*this, "weight", 0.5, {.live = true, .doc = "of a new value, 0 to 1"}};
  double mean_ = 0;
};

}  // namespace @NAMESPACE@

SEGUE_COMPONENT(@NAMESPACE@::Averager)
)";

std::string replaced(std::string_view text, std::string_view what, std::string_view by) {
  std::string result(text);
  for (auto at = result.find(what); at != std::string::npos; at = result.find(what, at + by.size())) {
    result.replace(at, what.size(), by);
  }
  return result;
}

/// A robot's name may hold '-', '.' and ':', a namespace none of them.
std::string namespace_of(std::string robot) {
  for (char& c : robot)
    c = c == '-' || c == '.' || c == ':' ? '_' : c;
  return robot;
}

}  // namespace

std::vector<NewFile> init_files(const std::string& robot, bool library) {
  const std::string name = namespace_of(robot);
  std::vector<NewFile> files = {{"robot.yaml", replaced(kRobotFile, "@ROBOT@", robot)},
                                {"controllers/explore.yaml", std::string(kExplore)},
                                {"controllers/go_to.yaml", std::string(kGoal)},
                                {"controllers/manual.yaml", std::string(kManual)},
                                {"controllers/hold.yaml", std::string(kControllerFile)},
                                {"missions/visit.yaml", std::string(kMissionFile)},
                                {"README.md", replaced(kReadme, "@ROBOT@", robot)}};
  if (!library) return files;
  files.back().text += replaced(kLibraryReadme, "@ROBOT@", name);
  files.push_back({"components/CMakeLists.txt", replaced(kCMake, "@ROBOT@", name)});
  files.push_back({"components/averager.cpp", replaced(kComponent, "@NAMESPACE@", name)});
  return files;
}

}  // namespace segue::cli
