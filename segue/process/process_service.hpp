// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/model/network.hpp>
#include <segue/process/launch.hpp>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace segue::process {

/// How a process ended.
struct ExitReason {
  int status = 0;  ///< its exit status, where `signal` is 0
  int signal = 0;  ///< the signal that ended it
  bool core_dumped = false;
  bool known = true;       ///< false: it was adopted, and only its parent is told
  bool requested = false;  ///< stop() or kill() was asked for it
  bool killed = false;     ///< kill() was asked for it, or stop() had to kill it at its deadline
};
/// "ended with status 3", "was ended by SIGSEGV (memory)": for events.
std::string to_string(const ExitReason& reason);

/// A deployment process.
struct ProcessInfo {
  std::string robot;
  model::DeploymentKey key;
  int pid = 0;
  std::filesystem::path socket;    ///< where it serves DeploymentService
  std::filesystem::path log;       ///< what it prints; older parts beside it as .1, .2 ...
  bool adopted = false;            ///< found running, not started by this server
  std::optional<ExitReason> exit;  ///< it has ended
};

/// Starts, stops and watches deployment processes; in this process (ProcessServer) or as the daemon `segue
/// host`. Functions may be called from any thread.
class ProcessService {
 public:
  virtual ~ProcessService() = default;

  /// Starts the process; answers when it exists (its socket accepts calls, which it answers once it is
  /// ready). AlreadyExists where one of that robot and name runs; a process of another version that holds the
  /// name is ended first.
  virtual Result<ProcessInfo> start(const Launch& launch, TimePoint deadline) = 0;
  /// Asks it to go (SIGTERM: tasks stopped and cleaned up in order) and kills its process group at
  /// `deadline`. Answers when it is gone. NotFound where there is none.
  virtual Result<ExitReason> stop(const std::string& robot, const model::DeploymentKey& key,
                                  TimePoint deadline) = 0;
  /// Kills its process group at once, without asking it to go. Answers when it is gone; else as stop().
  virtual Result<ExitReason> kill(const std::string& robot, const model::DeploymentKey& key,
                                  TimePoint deadline) = 0;
  /// Those of `robot` that run, found running ones included.
  virtual Result<std::vector<ProcessInfo>> processes(const std::string& robot) = 0;

  /// Called once for every process that ends, from any thread; must not block. No call is under way any more
  /// when set_listener returns.
  using Listener = std::function<void(const ProcessInfo&)>;
  virtual void set_listener(Listener listener) = 0;
};

}  // namespace segue::process
