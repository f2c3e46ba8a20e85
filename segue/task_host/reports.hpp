// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/recent_log.hpp>
#include <segue/model/network.hpp>
#include <segue/sample_link/latency.hpp>
#include <segue/task/timing.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

/// A host's reports on its tasks, its connections, its computers and changes to them.
namespace segue::task_host {

/// The observed state of a task.
struct TaskReport {
  model::TaskId id;
  model::ComponentName component;
  model::DeploymentKey process;
  int pid = 0;
  TaskState state = TaskState::PreOperational;
  std::string state_name;  ///< the named sub-state
  std::string error;
  bool stand_in = false;
  Activity activity;
  task::Timing timing;
  bool unknown = false;  ///< its computer cannot be reached: all this is what was known last
};

/// Details of a task that are reported on request only, since they would make each list of tasks large.
struct TaskDetails {
  task::TimingHistograms timing;  ///< since its last start
  /// Its newest lines, oldest first, as long as its process lives. They are found by its id, of which the
  /// first RealtimeLog::kSourceBytes count.
  std::vector<LogLine> log{};
};

/// Counts of samples since the connection was made, and how long they took.
struct ConnectionReport {
  model::Connection connection;
  std::uint64_t written = 0;
  std::uint64_t read = 0;
  std::uint64_t dropped = 0;
  /// The time from the write to the read. Between hosts without the way over the network: their clocks
  /// differ.
  sample_link::Latency latency{};
  /// The reason why the connection has been ended and is missing; empty: it is not.
  std::string error{};
};

/// A task changed its state other than by an action.
struct TaskEvent {
  model::TaskId task;
  TaskState state = TaskState::Exception;
  std::string message;
};

/// A change in a deployment process that no action caused.
struct ProcessEvent {
  model::DeploymentKey process;
  std::string message;
  bool gone = false;  ///< it has ended, and its tasks with it
};

/// The connection to a computer was lost, or is reachable again.
struct ComputerEvent {
  model::HostName host;
  bool reachable = false;
  std::string message;
};

/// Another runtime has got the robot (TaskHost::loss()).
struct LossEvent {
  std::string message;
};

using HostEvent = std::variant<TaskEvent, ProcessEvent, ComputerEvent, LossEvent>;

/// A computer that may hold deployments of the robot, as its runtime sees it.
struct ComputerReport {
  model::HostName name;
  bool reachable = true;
  bool optional = false;         ///< what it holds may be missing
  std::string state;             ///< "connected", or why it cannot be reached
  Duration since{0};             ///< for how long it has been so
  std::uint64_t connection = 0;  ///< its number: another one after each time that it was made anew
  std::string address;
  std::string software;                    ///< version of Segue
  std::optional<Duration> round_trip{};    ///< of a message there and back; the shortest of late
  std::optional<Duration> clock_offset{};  ///< how far its wall clock is ahead of this computer's
};

}  // namespace segue::task_host
