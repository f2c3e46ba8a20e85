// SPDX-License-Identifier: Apache-2.0
// The simulated rover is stopped at random moments of its missions, in every way, while its planners work and
// while it switches. Each time it comes to rest and stays there; how long that took and how far it drove is
// printed. Beside load, it may miss the time of its robot file; its devices are stopped then.
// SEGUE_ROVER_STOPS=100 stops it as often, SEGUE_SEED=n at other moments, SEGUE_STOPS_LOAD=20 beside
// as many threads that compute all the time.
#include <support/number_from.hpp>

#include <gmock/gmock.h>

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <map>
#include <numbers>
#include <random>
#include <stop_token>
#include <thread>

#include "rover_recording.hpp"
#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::IsEmpty;

enum class By { Stop, MissionStop, KilledMission, Button };
constexpr std::array kBy = {By::Stop, By::MissionStop, By::KilledMission, By::Button};
constexpr std::array kByNames = {"segue stop", "segue mission stop", "killed mission", "stop button"};

enum class During { Mission, Planning, Switch };
constexpr std::array kDuring = {During::Mission, During::Planning, During::Switch};
constexpr std::array kDuringNames = {"at any time", "while it plans", "during a switch"};

struct Stop {
  By by = By::Stop;
  During during = During::Mission;
  Standstill standstill;
  double halt = 0;      ///< s from the stop until the robot was halted
  double rest = 0;      ///< s from the stop until the robot was at rest, or its devices were stopped
  bool in_time = true;  ///< it was at rest within the time of its robot file
};

constexpr std::size_t kFewStops = 4;

void print_stop(std::size_t number, const Stop& stop) {
  const Standstill& still = stop.standstill;
  fmt::print("{} by {}, {}: halted after {:.0f} ms, {}{}at rest after {:.0f} ms\n", number,
             kByNames.at(static_cast<std::size_t>(stop.by)),
             kDuringNames.at(static_cast<std::size_t>(stop.during)), 1e3 * stop.halt,
             still.drove ? fmt::format("wheels still after {:.0f} ms, driven {:.0f} mm, ", 1e3 * still.wheels,
                                       1e3 * still.way.distance)
                         : "",
             still.moved_arm ? fmt::format("arm still after {:.0f} ms, ", 1e3 * still.arm) : "",
             1e3 * stop.rest);
  std::fflush(stdout);
}

double quantile(std::vector<double> values, double part) {
  std::ranges::sort(values);
  return values.at(static_cast<std::size_t>(std::ceil(part * static_cast<double>(values.size() - 1))));
}

void print_row(const std::string& stops, const char* what, const std::vector<double>& values) {
  if (values.empty()) return;
  fmt::print("{:<20} {:<30} {:>4} {:>8.0f} {:>8.0f} {:>8.0f} {:>8.0f}\n", stops, what, values.size(),
             quantile(values, 0), quantile(values, 0.5), quantile(values, 0.99), quantile(values, 1));
}

void print_rows(const std::string& name, const std::vector<Stop>& stops) {
  std::vector<double> braking;
  std::vector<double> wheels;
  std::vector<double> driven;
  std::vector<double> turned;
  std::vector<double> arm;
  std::vector<double> halt;
  std::vector<double> rest;
  for (const Stop& stop : stops) {
    halt.push_back(1e3 * stop.halt);
    rest.push_back(1e3 * stop.rest);
    if (stop.standstill.moved_arm) arm.push_back(1e3 * stop.standstill.arm);
    if (!stop.standstill.drove) continue;
    braking.push_back(1e3 * stop.standstill.braking);
    wheels.push_back(1e3 * stop.standstill.wheels);
    driven.push_back(1e3 * stop.standstill.way.distance);
    turned.push_back(180 / std::numbers::pi * stop.standstill.way.turn);
  }
  print_row(name, "the robot is halted, ms", halt);
  print_row(name, "the wheels begin to brake, ms", braking);
  print_row(name, "wheels commanded still, ms", wheels);
  print_row(name, "driven after the stop, mm", driven);
  print_row(name, "turned after the stop, degrees", turned);
  print_row(name, "arm commanded still, ms", arm);
  print_row(name, "at rest, ms", rest);
}

/// Times from the stop; of wheels and arm only where they moved.
void print_table(const std::vector<Stop>& all) {
  fmt::print("{:<20} {:<30} {:>4} {:>8} {:>8} {:>8} {:>8}\n", "stopped", "", "of", "min", "p50", "p99",
             "max");
  std::map<std::string, std::vector<Stop>> groups;
  for (const Stop& stop : all) {
    groups[std::string("by ") + kByNames.at(static_cast<std::size_t>(stop.by))].push_back(stop);
    groups[kDuringNames.at(static_cast<std::size_t>(stop.during))].push_back(stop);
  }
  for (const auto& [name, stops] : groups)
    print_rows(name, stops);
  print_rows("all", all);
  fmt::print("{} of {} were at rest in time\n", std::ranges::count_if(all, &Stop::in_time), all.size());
}

/// Threads that compute as long as this lives.
class Load {
 public:
  explicit Load(int threads) {
    for (int i = 0; i < threads; ++i)
      threads_.emplace_back([this](const std::stop_token& stop) {
        while (!stop.stop_requested())
          ++turns_;
      });
  }

 private:
  std::atomic<std::uint64_t> turns_ = 0;
  std::vector<std::jthread> threads_;
};

class RoverStops : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    const auto example = segue::paths::in_sources("/examples/08_rover");
    std::filesystem::copy(example, folder_ / "example", std::filesystem::copy_options::recursive);
  }
  double random_between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  /// Ends at a moment that the test has chosen.
  static void pass(double seconds) {
    const auto end = RealClock::instance().now() +
                     std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
    EXPECT_TRUE(eventually([&] { return RealClock::instance().now() >= end; }));
  }
  void start_robot(During during) {
    const std::string file = during == During::Planning ? "example/table_robot.yaml" : "example/robot.yaml";
    robot_ = std::make_unique<Process>(command({"run", file}), folder_);
    ASSERT_TRUE(robot_->wait_for("runs (pid"));
    const auto switched = segue({"switch", "hold+guard"});
    ASSERT_EQ(switched.status, 0) << switched.errors;
  }
  std::unique_ptr<Process> begin_mission(During during) {
    std::vector<std::string> arguments = {"mission", "run", "--no-progress"};
    if (during == During::Planning) {
      arguments.insert(arguments.end(),
                       {"example/clear_table.yaml", "--mode", "concurrent", "--input", "tilts=48"});
    } else {
      arguments.emplace_back("example/fetch_box.yaml");
    }
    return std::make_unique<Process>(command(arguments), folder_);
  }
  /// Until the robot shall be stopped.
  void wait_for_moment(During during, Process& events) {
    if (during == During::Mission) return pass(random_between(1, 12));
    if (during == During::Planning) return pass(random_between(1.5, 8));
    const int transition = 1 + static_cast<int>(random_() % 3);
    EXPECT_TRUE(events.wait_until([&](const std::string& output) {
      int begun = 0;
      for (auto at = output.find(" actions\n"); at != std::string::npos;
           at = output.find(" actions\n", at + 1)) {
        const std::string line = output.substr(output.rfind('\n', at) + 1, at - output.rfind('\n', at));
        if (line.find("from '") != std::string::npos) ++begun;
      }
      return begun >= transition;
    }));
    pass(random_between(0, 0.1));
  }
  /// What stops it waits for rest, and fails where that does not come in time; whether it came is asked
  /// later.
  void stop_robot(By by, const Process& mission) {
    switch (by) {
      case By::Stop:
        (void)segue({"stop"});
        break;
      case By::MissionStop:
        (void)segue({"mission", "stop"});
        break;
      case By::KilledMission:
        mission.signal(SIGKILL);
        break;
      case By::Button:
        EXPECT_EQ(segue({"call", "stop_button.press", "--beside-mission"}).status, 0);
        break;
    }
  }
  /// Notes when the robot was at rest, as it says itself; s after `stopped`, which is since the epoch.
  void wait_for_rest(double stopped, Stop& stop) {
    bool devices_are_stopped = false;
    EXPECT_TRUE(eventually([&] {
      const auto status = json({"status"});
      const auto* halt = status.find("halt");
      if (halt == nullptr || halt->is_null() || halt->find("state")->as_string() == "halting") return false;
      stop.in_time = halt->find("state")->as_string() == "at_rest";
      devices_are_stopped = !halt->find("stopped")->as_list().empty();
      stop.halt = halt->find("time_s")->as_double() - stopped;
      stop.rest = stop.halt + halt->find("duration_s")->as_double();
      return true;
    }));
    EXPECT_TRUE(stop.in_time || (load_ > 0 && devices_are_stopped)) << segue({"status"}).output;
  }
  void pass_robot_time(double seconds) {
    const double begin = json({"read", "rover.time"}).as_double();
    EXPECT_TRUE(eventually([&] { return json({"read", "rover.time"}).as_double() > begin + seconds; }));
  }
  void stop_once(Stop& stop) {
    ASSERT_NO_FATAL_FAILURE(start_robot(stop.during));
    Process events(command({"events", "--follow"}), folder_);
    RoverRecording recording(folder_);
    const auto mission = begin_mission(stop.during);
    wait_for_moment(stop.during, events);
    EXPECT_FALSE(mission->has_ended()) << mission->wait().output << mission->wait().errors;
    const TimePoint stopped = RealClock::instance().now();
    const double stopped_s =
        std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
    stop_robot(stop.by, *mission);
    wait_for_rest(stopped_s, stop);
    const TimePoint rest = RealClock::instance().now();
    pass_robot_time(1);
    recording.end();
    stop.standstill = recording.standstill(stopped);
    const AfterRest after = recording.after_rest(rest);
    EXPECT_THAT(after.commands, IsEmpty()) << "nothing moves it once it is at rest";
    EXPECT_LT(after.way.distance, 0.005) << "m, that it drove at rest";
    EXPECT_LT(after.way.turn, 0.01) << "rad, that it turned at rest";
    (void)mission->wait();
    EXPECT_EQ(controller(), stop.in_time ? "guard+hold" : "stopped");
    EXPECT_EQ(this->stop().status, 0);
  }

  const int load_ = number_from("SEGUE_STOPS_LOAD", 0);
  std::mt19937_64 random_{static_cast<std::uint64_t>(number_from("SEGUE_SEED", 1))};
};

TEST_F(RoverStops, BringItToRestWheneverTheyCome) {
  const Load load(load_);
  std::vector<Stop> stops;
  const auto count = static_cast<std::size_t>(number_from("SEGUE_ROVER_STOPS", kFewStops));
  for (std::size_t i = 0; i < count && !HasFailure(); ++i) {
    Stop stop{kBy.at(i % kBy.size()), kDuring.at(i % kDuring.size()), {}, 0, 0, true};
    SCOPED_TRACE(fmt::format("stop {}, by {}, {}", i, kByNames.at(i % kByNames.size()),
                             kDuringNames.at(i % kDuringNames.size())));
    ASSERT_NO_FATAL_FAILURE(stop_once(stop));
    stops.push_back(stop);
    if (count > kFewStops) print_stop(i, stop);
  }
  print_table(stops);
}

}  // namespace
}  // namespace segue::testing
