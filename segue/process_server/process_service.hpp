// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/model/network.hpp>
#include <segue/process_server/launch.hpp>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace segue::process_server {

/// How a process ended.
struct ExitReason {
  int status = 0;  ///< exit status; valid where `signal` is 0
  int signal = 0;  ///< the signal that ended it
  bool core_dumped = false;
  bool known = true;       ///< false: it was adopted, and only its parent can read its exit status
  bool requested = false;  ///< stop() or kill() was called
  bool killed = false;     ///< by kill(), or by stop() at its deadline
};
/// "ended with status 3", "was ended by SIGSEGV (memory)": for events.
std::string to_string(const ExitReason& reason);

/// A deployment process.
struct ProcessInfo {
  std::string robot;
  model::DeploymentKey key;
  int pid = 0;
  std::filesystem::path socket;    ///< where it serves DeploymentService
  std::filesystem::path log;       ///< its output; older parts are in .1, .2 ... beside it
  bool adopted = false;            ///< was found running, not started by this server
  std::optional<ExitReason> exit;  ///< set once it has ended
};

/// Starts, stops and watches deployment processes, in this process (ProcessServer) or in the daemon `segue
/// host`. Functions may be called from any thread.
class ProcessService {
 public:
  virtual ~ProcessService() = default;

  /// Starts a process and returns as soon as its socket accepts connections, which it serves once it is
  /// ready. AlreadyExists where a process of that robot and name runs; one of another version of Segue is
  /// ended first. Blocks until `deadline` at most.
  virtual Result<ProcessInfo> start(const Launch& launch, TimePoint deadline) = 0;
  /// Ends a process by SIGTERM, on which it stops and cleans up its tasks; kills its process group at
  /// `deadline`. Returns when it has ended. NotFound where it does not run.
  virtual Result<ExitReason> stop(const std::string& robot, const model::DeploymentKey& key,
                                  TimePoint deadline) = 0;
  /// Kills the process group of a process at once. Returns when it has ended. NotFound where it does not run.
  virtual Result<ExitReason> kill(const std::string& robot, const model::DeploymentKey& key,
                                  TimePoint deadline) = 0;
  /// The running processes of `robot`, whoever started them.
  virtual Result<std::vector<ProcessInfo>> processes(const std::string& robot) = 0;

  /// Called once for every process that ends, from any thread; must not block.
  using Listener = std::function<void(const ProcessInfo&)>;
  /// Replaces the listener. The former one is not being called any more when this returns.
  virtual void set_listener(Listener listener) = 0;
};

}  // namespace segue::process_server
