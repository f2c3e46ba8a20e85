// SPDX-License-Identifier: Apache-2.0
// Whether a switch leaves a gap in what the simulated rover is commanded: all twelve transitions between
// explore, go_to, reach and teleop of example 08 while it moves, each beside as long a time without one.
//
//   rover_switch_bench [ROUNDS]      default: 2
//
// Once with the normal scheduler, and once as the example has it: the five tasks that all controllers share
// have a real-time one, where that is permitted.
#include "support/robot.hpp"

#include <segue/base/clock.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/task_host/task_host.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace {

using namespace bench;
using namespace segue;
using namespace std::chrono_literals;
using type::Value;

constexpr const char* kRobot = SEGUE_SOURCE_DIR "/examples/08_rover/robot.yaml";

// Every transition once, each beginning where the last one ended.
constexpr std::array kWalk = {"explore", "go_to", "explore", "reach", "explore", "teleop", "go_to",
                              "reach",   "go_to", "teleop",  "reach", "teleop",  "explore"};
constexpr double kPeriod = 0.01;  // s, of the simulation and of the trajectory generator
constexpr std::size_t kJoints = 6;

double seconds(TimePoint time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

double number(const Value& sample, const char* field) {
  return sample.find(field)->as_double();
}

std::array<double, kJoints> joints(const Value& sample, const char* field) {
  std::array<double, kJoints> numbers{};
  const auto& list = sample.find(field)->as_list();
  for (std::size_t i = 0; i < kJoints; ++i)
    numbers.at(i) = list.at(i).as_double();
  return numbers;
}

/// An update of the simulation.
struct Update {
  double time = 0;   ///< s, the robot's clock
  double clock = 0;  ///< s, the computer's
  bool wheels = false;
  bool arm = false;  ///< new set points have arrived since the last update
};

/// How the arm is to move, or moves.
struct Motion {
  double time = 0;  ///< s, the robot's clock
  std::array<double, kJoints> velocities{};
};

struct Window {
  double begin = 0;
  double end = 0;  ///< s, the computer's clock
};

/// Everything that was commanded, used and measured.
class Record {
 public:
  explicit Record(runtime::EmbeddedRobot& robot)
      : ages_(open(robot, "rover", "set_point_ages")),
        arm_(open(robot, "rover", "arm_state")),
        set_points_(open(robot, "trajectory", "set_points")) {}

  /// To be called at least once in a minute.
  void drain() {
    for (const Value& sample : ages_->read(kBuffer)) {
      updates.push_back({number(sample, "time"), number(sample, "clock"),
                         sample.find("wheels")->as_int() == 0, sample.find("arm")->as_int() == 0});
    }
    for (const Value& sample : arm_->read(kBuffer))
      measured.push_back({number(sample, "time"), joints(sample, "velocities")});
    for (const Value& sample : set_points_->read(kBuffer))
      set_points.push_back({number(sample, "time"), joints(sample, "velocities")});
  }

  std::vector<Update> updates;
  std::vector<Motion> measured;
  std::vector<Motion> set_points;

 private:
  static constexpr std::size_t kBuffer = 10'000;
  static std::unique_ptr<task_host::PortReader> open(runtime::EmbeddedRobot& robot, const char* task,
                                                     const char* port) {
    auto reader = robot.host().open_reader({model::TaskId(task), port}, kBuffer);
    if (!reader) {
      std::fprintf(stderr, "%s\n", to_string(reader.error()).c_str());
      std::exit(1);
    }
    return std::move(*reader);
  }

  std::unique_ptr<task_host::PortReader> ages_;
  std::unique_ptr<task_host::PortReader> arm_;
  std::unique_ptr<task_host::PortReader> set_points_;
};

/// The times between the commands of one stream.
struct Gaps {
  std::size_t commands = 0;
  std::size_t missed = 0;  ///< cycles without one
  double longest = 0;      ///< s
  double cycles = 0;       ///< the longest, as a number of cycles

  void add(double gap, double in_cycles) {
    ++commands;
    longest = std::max(longest, gap);
    cycles = std::max(cycles, in_cycles);
    missed += static_cast<std::size_t>(std::max(0.0, std::round(in_cycles) - 1));
  }
};

/// The largest magnitudes, by differences.
struct Peaks {
  double velocity = 0;
  double acceleration = 0;
  double jerk = 0;
};

bool inside(const std::vector<Window>& windows, double time) {
  return std::ranges::any_of(
      windows, [time](const Window& window) { return time >= window.begin && time <= window.end; });
}

/// Gaps of the set points that the simulation went by.
Gaps gaps_of(const std::vector<Update>& updates, bool Update::*fresh, const std::vector<Window>& windows) {
  Gaps gaps;
  const Update* last = nullptr;
  for (const Update& update : updates) {
    if (!(update.*fresh)) continue;
    if (last != nullptr && inside(windows, update.clock))
      gaps.add(update.clock - last->clock, (update.time - last->time) / kPeriod);
    last = &update;
  }
  return gaps;
}

/// Gaps of the set points of the generator, which has a cycle for each update.
Gaps gaps_of(const std::vector<Motion>& set_points, const std::vector<Update>& updates,
             const std::vector<Window>& windows) {
  Gaps gaps;
  const auto clock = [&](double time) {
    const auto update = std::ranges::lower_bound(updates, time - kPeriod / 2, {}, &Update::time);
    return update == updates.end() ? updates.back().clock : update->clock;
  };
  for (std::size_t i = 1; i < set_points.size(); ++i) {
    const double now = clock(set_points[i].time);
    if (inside(windows, now))
      gaps.add(now - clock(set_points[i - 1].time), (set_points[i].time - set_points[i - 1].time) / kPeriod);
  }
  return gaps;
}

Peaks peaks_of(const std::vector<Motion>& motions, const std::vector<Window>& windows) {
  Peaks peaks;
  for (std::size_t i = 2; i < motions.size(); ++i) {
    if (!inside(windows, motions[i].time)) continue;
    const double step = motions[i].time - motions[i - 1].time;
    const double step_before = motions[i - 1].time - motions[i - 2].time;
    if (step <= 0 || step_before <= 0) continue;
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      const double now = motions[i].velocities.at(joint);
      const double before = motions[i - 1].velocities.at(joint);
      const double acceleration = (now - before) / step;
      const double earlier = (before - motions[i - 2].velocities.at(joint)) / step_before;
      peaks.velocity = std::max(peaks.velocity, std::abs(now));
      peaks.acceleration = std::max(peaks.acceleration, std::abs(acceleration));
      peaks.jerk = std::max(peaks.jerk, std::abs(acceleration - earlier) / ((step + step_before) / 2));
    }
  }
  return peaks;
}

/// A controller of the example, which gives the five tasks that all share a real-time scheduler.
model::Network controller(runtime::EmbeddedRobot& robot, const char* name, bool real_time) {
  model::Network network = robot.runtime().controller(model::NetworkName(name)).value();
  for (model::Task& task : network.tasks) {
    if (real_time || !task.activity) continue;
    task.activity->scheduler = Scheduler::Normal;
    task.activity->priority = 0;
  }
  return network;
}

/// A robot that never stands still.
class Rover {
 public:
  explicit Rover(bool real_time) : real_time_(real_time) {
    runtime::EmbeddedOptions options;
    options.placement = runtime::TaskPlacement::Processes;
    options.log_level = LogLevel::Error;
    robot_.emplace(bench::open(kRobot, options));
    done(robot_->runtime().switch_to(controller(*robot_, kWalk.front(), real_time_)));
    record_ = std::make_unique<Record>(*robot_);
  }

  void walk(int rounds) {
    for (int round = 0; round < rounds; ++round) {
      for (std::size_t i = 1; i < kWalk.size(); ++i) {
        set_in_motion(kWalk.at(i - 1));
        const Window window = switched_to(kWalk.at(i));
        transitions[std::string(kWalk.at(i - 1)) + " -> " + kWalk.at(i)].push_back(window);
        all_transitions.push_back(window);
        // A window of the same length without a switch, with the same motion.
        std::this_thread::sleep_for(500ms);
        set_in_motion(kWalk.at(i));
        const double begin = seconds(RealClock::instance().now());
        std::this_thread::sleep_for(std::chrono::duration<double>(window.end - window.begin));
        idle.push_back({begin, seconds(RealClock::instance().now())});
        record_->drain();
      }
    }
  }
  void shut_down() {
    record_->drain();
    done(robot_->shut_down());
  }
  [[nodiscard]] const Record& record() const { return *record_; }

  std::map<std::string, std::vector<Window>> transitions;
  std::vector<Window> all_transitions;
  std::vector<Window> idle;

 private:
  static constexpr auto kAfter = 300ms;  // of the new controller, which belong to the transition

  Window switched_to(const char* name) {
    const model::Network target = controller(*robot_, name, real_time_);
    Window window{seconds(RealClock::instance().now()), 0};
    done(robot_->runtime().switch_to(target));
    std::this_thread::sleep_for(kAfter);
    window.end = seconds(RealClock::instance().now());
    return window;
  }

  /// explore and teleop move by themselves; in the others the arm gets a target, and go_to a place.
  void set_in_motion(const std::string& name) {
    const auto soon = [] { return RealClock::instance().now() + 10s; };
    there_ = !there_;
    const double side = there_ ? 1 : -1;
    if (name == "reach") {
      const Value pose =
          Value::map({{"position", Value::list({0.55, 0.2 * side, 0.75})},
                      {"orientation", Value::map({{"w", 0.0}, {"x", 0.7071}, {"y", 0.0}, {"z", 0.7071}})}});
      require(robot_->host().call(model::TaskId("cartesian"), "set_target", Value::map({{"target", pose}}),
                                  soon()));
    } else if (name != "teleop") {
      const double turn = 0.9 * side;
      const Value target =
          Value::map({{"positions", Value::list({turn, -1.2, 1.8, 0.3 * side, 0.4, 0.2 * side})}});
      require(robot_->host().write({model::TaskId("trajectory"), "command"}, target, soon()));
    }
    if (name == "go_to") {
      const Value goal = Value::map({{"x", -0.3 * side}, {"y", 0.0}, {"theta", 0.0}});
      require(
          robot_->host().call(model::TaskId("planner"), "set_goal", Value::map({{"goal", goal}}), soon()));
    }
    std::this_thread::sleep_for(400ms);
  }
  template <class T>
  static void require(const Result<T>& result) {
    if (result) return;
    std::fprintf(stderr, "%s\n", to_string(result.error()).c_str());
    std::exit(1);
  }

  bool real_time_;
  std::optional<runtime::EmbeddedRobot> robot_;
  std::unique_ptr<Record> record_;
  bool there_ = false;
};

/// The windows with their times converted to the robot's clock.
std::vector<Window> by_the_robots_clock(const std::vector<Update>& updates,
                                        const std::vector<Window>& windows) {
  std::vector<Window> found;
  const auto at = [&](double clock) {
    const auto next = std::ranges::lower_bound(updates, clock, {}, &Update::clock);
    return next == updates.end() ? updates.back().time : next->time;
  };
  for (const Window& window : windows)
    found.push_back({at(window.begin), at(window.end)});
  return found;
}

void print(const char* name, const Gaps& gaps) {
  std::printf("  %-44s%7zu of %6zu %12.1f%12.0f\n", name, gaps.missed, gaps.commands + gaps.missed,
              1e3 * gaps.longest, gaps.cycles);
}

void print(const char* name, const Peaks& peaks) {
  std::printf("  %-44s%10.2f%14.2f%12.1f\n", name, peaks.velocity, peaks.acceleration, peaks.jerk);
}

void report(const Rover& rover) {
  const Record& record = rover.record();
  std::printf("\n%-46s%17s%13s%12s\n", "Commands, period 10 ms", "cycles missed", "longest, ms", "in cycles");
  for (const auto& [name, windows] :
       {std::pair{"transitions", &rover.all_transitions}, std::pair{"idle for as long", &rover.idle}}) {
    std::printf(" %s\n", name);
    print("set points of the arm, by the generator", gaps_of(record.set_points, record.updates, *windows));
    print("of the arm, used by the simulation", gaps_of(record.updates, &Update::arm, *windows));
    print("of the wheels, used by the simulation", gaps_of(record.updates, &Update::wheels, *windows));
  }
  std::printf("\n%-46s%10s%14s%12s\n", "Joints of the arm, largest", "rad/s", "rad/s^2", "rad/s^3");
  print("limits of the generator", Peaks{1, 3, 30});
  for (const auto& [name, windows] :
       {std::pair{"transitions", &rover.all_transitions}, std::pair{"idle for as long", &rover.idle}}) {
    std::printf(" %s\n", name);
    print("set points", peaks_of(record.set_points, by_the_robots_clock(record.updates, *windows)));
    print("measured", peaks_of(record.measured, by_the_robots_clock(record.updates, *windows)));
  }
  std::printf("\n%-24s%36s%36s\n", "Transition", "longest arm / wheels, ms", "missed arm / wheels");
  for (const auto& [name, windows] : rover.transitions) {
    const Gaps arm = gaps_of(record.updates, &Update::arm, windows);
    const Gaps wheels = gaps_of(record.updates, &Update::wheels, windows);
    std::printf("%-24s%27.1f /%7.1f%27zu /%7zu\n", name.c_str(), 1e3 * arm.longest, 1e3 * wheels.longest,
                arm.missed, wheels.missed);
  }
}

}  // namespace

int main(int argc, char** argv) {
  ::setenv("SEGUE_LIBRARY_PATH", SEGUE_BENCH_LIBRARIES, 0);
  ::setenv("SEGUE_DEPLOYMENT", SEGUE_BENCH_DEPLOYMENT, 0);
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 2;
  if (rounds < 1) {
    std::fputs("usage: rover_switch_bench [ROUNDS]\n", stderr);
    return 2;
  }
  for (const bool real_time : {false, true}) {
    Rover rover(real_time);
    rover.walk(rounds);
    rover.shut_down();
    std::printf("\n%d transitions, %s scheduler\n", rounds * static_cast<int>(kWalk.size() - 1),
                real_time ? "real-time" : "normal");
    report(rover);
  }
}
