// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/error.hpp>
#include <segue/model/halt.hpp>
#include <segue/model/ids.hpp>
#include <segue/model/network.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace segue::model {

/// A computer of a robot.
struct Host {
  HostName name;
  std::string address;      ///< "local", "tcp://10.0.0.2:7447" or "unix:/run/segue/@host.sock"
  std::string credentials;  ///< folder of certificates, for TCP; empty: the user's own
  bool optional = false;    ///< the robot can be switched while it cannot be reached
  [[nodiscard]] bool is_local() const { return address == "local"; }
  friend bool operator==(const Host&, const Host&) = default;
};

/// How often, and after which delay, a faulty part is started anew.
struct RestartPolicy {
  int max = 3;  ///< attempts before giving up
  Duration backoff =
      std::chrono::milliseconds(100);  ///< before the first attempt; doubled for each further one
  friend bool operator==(const RestartPolicy&, const RestartPolicy&) = default;
};

/// Reactions of the runtime to faults.
struct Policies {
  FailurePolicy on_failure = FailurePolicy::Report;  ///< unless a task or deployment names another
  RestartPolicy restart;
  Duration watch = std::chrono::seconds(1);  ///< period of supervision, in addition to every event
  friend bool operator==(const Policies&, const Policies&) = default;
};

/// Resource limits of all standby controllers together.
struct LookAhead {
  int processes = 8;
  std::uint64_t memory = 2'000'000'000;  ///< bytes
  friend bool operator==(const LookAhead&, const LookAhead&) = default;
};

/// Equal tasks, each in a process of its own, that run beside every controller. Switches leave them alone;
/// the runtime restarts those that fail. Missions call their operations.
struct Pool {
  std::string name;
  int least = 1;  ///< instances that always run
  int most = 1;   ///< instances that run where as many calls wait, and the budget permits
  Duration idle_after = std::chrono::seconds(10);  ///< an instance beyond `least` ends without work
  Task task;                                       ///< each instance, but for its id
  Deployment process;                              ///< each one's process, but for its name and tasks
  SourceLocation where;
  friend bool operator==(const Pool& a, const Pool& b) {
    return a.name == b.name && a.least == b.least && a.most == b.most && a.idle_after == b.idle_after &&
           a.task == b.task && a.process == b.process;
  }
};
inline constexpr int kLargestPool = 256;
/// Limits, on each computer, of the instances that all pools together have beyond their least numbers.
struct PoolBudget {
  int processes = kLargestPool;
  std::uint64_t memory = 2'000'000'000;  ///< bytes
  friend bool operator==(const PoolBudget&, const PoolBudget&) = default;
};
/// "planner_2": the task of the second instance, counted from 1, and its process.
TaskId instance_of(const Pool& pool, int number);
/// The most instances of all pools; without a name.
Network pool_network(const std::vector<Pool>& pools);

/// The program that makes plans for missions (planner::PlannerCommand).
struct PlannerProgram {
  std::vector<std::string> command;
  Duration timeout = std::chrono::seconds(60);
  std::uint64_t memory = 0;  ///< bytes; 0: no limit
  friend bool operator==(const PlannerProgram&, const PlannerProgram&) = default;
};

/// A resource of the robot whose units outlive the runs of missions that use it. The robot keeps how many
/// there are; `count`, as long as nobody has changed it.
struct UnitStock {
  std::string name;
  std::uint32_t count = 0;
  friend bool operator==(const UnitStock&, const UnitStock&) = default;
};

/// A robot file: its hosts, libraries, controllers and missions. Paths are relative to `folder`.
struct Robot {
  std::string name;
  std::vector<Host> hosts;
  std::vector<std::string> libraries;    ///< component libraries: names, never paths
  std::vector<std::string> models;       ///< component model files (patterns) beyond those of the libraries
  std::vector<std::string> controllers;  ///< network files (patterns)
  std::vector<std::string> missions;
  std::vector<std::string> transitions;  ///< files of transitions that are written by hand (patterns)
  std::optional<NetworkName> fallback;
  std::optional<Halt> halt;
  Policies policies;
  LookAhead look_ahead;
  std::vector<Pool> pools;
  PoolBudget pool_budget;
  std::vector<UnitStock> units;
  std::optional<PlannerProgram> planner;  ///< nothing: the built-in one
  std::filesystem::path folder;
  SourceLocation where;
};

}  // namespace segue::model
