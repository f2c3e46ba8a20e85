// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "process.hpp"

namespace segue::testing {

/// Of the rover, in whatever directions.
struct Way {
  double distance = 0;  ///< m
  double turn = 0;      ///< rad
};

/// A robot of example 08 that was stopped at some moment: until when it was commanded to move, and how far it
/// went. Times in seconds of the computer from the stop, 0 where nothing moved.
struct Standstill {
  bool drove = false;      ///< the wheels were commanded to turn
  bool moved_arm = false;  ///< the arm was commanded to move
  double braking = 0;      ///< the first command of those that slow the wheels down to nothing
  double wheels = 0;       ///< the first command to the wheels that lets them stand still
  double arm = 0;          ///< the last command that moved the arm
  Way way;                 ///< after the stop
};

/// Whatever was commanded and how far the robot went after it was at rest.
struct AfterRest {
  std::vector<std::string> commands;  ///< each that moved it: "the wheels at 1.3 rad/s after 12 ms"
  Way way;
};

/// What the wheels and the arm are commanded in each update of the simulation, and where the rover really is,
/// from its construction until end(). The robot must run its tasks `rover`, `wheels` and `arm`.
class RoverRecording {
 public:
  /// Waits until all of it arrives. Whoever reads writes to files of `folder`.
  explicit RoverRecording(const std::filesystem::path& folder);
  /// Stops reading; what was recorded can be asked for.
  void end();

  [[nodiscard]] Standstill standstill(TimePoint stopped) const;
  [[nodiscard]] AfterRest after_rest(TimePoint rest) const;

 private:
  struct Update {
    double time;   ///< s, the robot's clock
    double clock;  ///< s, the computer's
  };
  struct Command {
    double time;
    std::vector<double> values;  ///< speeds of the wheels, or positions of the arm
  };
  struct Place {
    double time;
    double x;
    double y;
    double theta;
  };

  [[nodiscard]] std::vector<Command> commands(const char* port, const char* values) const;
  [[nodiscard]] double robot_time(TimePoint clock) const;
  [[nodiscard]] double clock(double robot_time) const;
  [[nodiscard]] Way way_since(double robot_time) const;

  std::filesystem::path folder_;
  std::vector<std::unique_ptr<Process>> readers_;
  std::vector<Update> updates_;
  std::vector<Command> wheels_;
  std::vector<Command> arm_;
  std::vector<Place> places_;
};

}  // namespace segue::testing
