// SPDX-License-Identifier: Apache-2.0
#include "rover_recording.hpp"

#include <segue/type/json.hpp>

#include <support/paths.hpp>

#include <gtest/gtest.h>

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <fstream>
#include <numbers>
#include <string>

namespace segue::testing {

namespace {

constexpr std::array kPorts = {"rover.set_point_ages", "rover.pose", "wheels.wheels", "arm.set_points"};

double seconds_of(TimePoint time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

/// All whole lines of a file.
std::vector<type::Value> samples_in(const std::filesystem::path& path) {
  std::vector<type::Value> samples;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line) && !file.eof();) {
    auto sample = type::parse_json(line);
    EXPECT_TRUE(sample) << line;
    if (sample) samples.push_back(*std::move(sample));
  }
  return samples;
}

double number(const type::Value& sample, const char* field) {
  return sample.find(field)->as_double();
}

double fastest(const std::vector<double>& speeds) {
  double fastest = 0;
  for (const double speed : speeds)
    fastest = std::max(fastest, std::abs(speed));
  return fastest;
}

double farthest(const std::vector<double>& from, const std::vector<double>& to) {
  double farthest = 0;
  for (std::size_t joint = 0; joint < std::min(from.size(), to.size()); ++joint)
    farthest = std::max(farthest, std::abs(to[joint] - from[joint]));
  return farthest;
}

/// By more than rounding.
bool moves(const std::vector<double>& from, const std::vector<double>& to) {
  return farthest(from, to) > 1e-9;
}

/// The angle between two headings, from 0 to pi.
double turn(double from, double to) {
  return std::abs(std::remainder(to - from, 2 * std::numbers::pi));
}

}  // namespace

RoverRecording::RoverRecording(const std::filesystem::path& folder) : folder_(folder) {
  for (const std::string port : kPorts) {
    std::filesystem::remove(folder / port);
    readers_.push_back(std::make_unique<Process>(
        std::vector<std::string>{"/bin/sh", "-c", "exec \"$0\" read \"$1\" --follow --format json > \"$1\"",
                                 segue::paths::kProgram, port},
        folder));
    const auto has_begun = [&] {
      return std::filesystem::exists(folder / port) && std::filesystem::file_size(folder / port) > 0;
    };
    EXPECT_TRUE(eventually(has_begun) && !readers_.back()->has_ended())
        << port << readers_.back()->wait().errors;
  }
}

void RoverRecording::end() {
  for (const auto& reader : readers_)
    reader->signal(SIGINT);
  for (const auto& reader : readers_)
    (void)reader->wait();
  for (const auto& sample : samples_in(folder_ / "rover.set_point_ages"))
    updates_.push_back({number(sample, "time"), number(sample, "clock")});
  for (const auto& sample : samples_in(folder_ / "rover.pose")) {
    const auto& pose = *sample.find("pose");
    places_.push_back({number(sample, "time"), number(pose, "x"), number(pose, "y"), number(pose, "theta")});
  }
  wheels_ = commands("wheels.wheels", "speeds");
  arm_ = commands("arm.set_points", "positions");
  ASSERT_FALSE(updates_.empty() || places_.empty() || wheels_.empty() || arm_.empty());
}

std::vector<RoverRecording::Command> RoverRecording::commands(const char* port, const char* values) const {
  std::vector<Command> all;
  for (const auto& sample : samples_in(folder_ / port)) {
    Command command{number(sample, "time"), {}};
    for (const auto& value : sample.find(values)->as_list())
      command.values.push_back(value.as_double());
    all.push_back(std::move(command));
  }
  return all;
}

double RoverRecording::robot_time(TimePoint clock) const {
  const auto next = std::ranges::lower_bound(updates_, seconds_of(clock), {}, &Update::clock);
  return next == updates_.end() ? updates_.back().time : next->time;
}

double RoverRecording::clock(double robot_time) const {
  const auto next = std::ranges::lower_bound(updates_, robot_time, {}, &Update::time);
  return next == updates_.end() ? updates_.back().clock : next->clock;
}

Way RoverRecording::way_since(double robot_time) const {
  Way way;
  for (std::size_t i = 1; i < places_.size(); ++i) {
    if (places_[i - 1].time < robot_time) continue;
    way.distance += std::hypot(places_[i].x - places_[i - 1].x, places_[i].y - places_[i - 1].y);
    way.turn += turn(places_[i - 1].theta, places_[i].theta);
  }
  return way;
}

Standstill RoverRecording::standstill(TimePoint stopped) const {
  const double begin = robot_time(stopped);
  const auto since = [&](double robot_time) {
    return std::max(0.0, clock(robot_time) - seconds_of(stopped));
  };
  Standstill found;
  found.way = way_since(begin);
  std::size_t still = wheels_.size();  // the first command of those that let the wheels stand still
  while (still > 0 && wheels_[still - 1].time >= begin && fastest(wheels_[still - 1].values) == 0)
    --still;
  found.drove = still > 0 && wheels_[still - 1].time >= begin;
  if (found.drove && still < wheels_.size()) {
    std::size_t braking = still;
    while (braking > 1 && wheels_[braking - 1].time >= begin &&
           fastest(wheels_[braking - 1].values) < fastest(wheels_[braking - 2].values))
      --braking;
    found.wheels = since(wheels_[still].time);
    found.braking = since(wheels_[braking].time);
  }
  for (std::size_t i = 1; i < arm_.size(); ++i) {
    if (arm_[i].time < begin || !moves(arm_[i - 1].values, arm_[i].values)) continue;
    found.moved_arm = true;
    found.arm = since(arm_[i].time);
  }
  return found;
}

AfterRest RoverRecording::after_rest(TimePoint rest) const {
  const double begin = robot_time(rest);
  AfterRest found;
  found.way = way_since(begin);
  const auto note = [&](const char* what, double amount, const char* unit, double time) {
    found.commands.push_back(
        fmt::format("{} {:.3g} {} after {:.0f} ms", what, amount, unit, 1e3 * (time - begin)));
  };
  for (const auto& command : wheels_) {
    if (command.time > begin && fastest(command.values) > 0)
      note("the wheels at", fastest(command.values), "rad/s", command.time);
  }
  for (std::size_t i = 1; i < arm_.size(); ++i) {
    if (arm_[i - 1].time > begin && moves(arm_[i - 1].values, arm_[i].values))
      note("the arm by", farthest(arm_[i - 1].values, arm_[i].values), "rad", arm_[i].time);
  }
  return found;
}

}  // namespace segue::testing
