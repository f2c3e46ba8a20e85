// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/distributed/hosted_robot.hpp>
#include <segue/process_server/launch.hpp>
#include <segue/process_server/process_log.hpp>

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace segue::distributed {

/// A component library that is installed on a host.
struct LibraryInfo {
  std::string name;
  std::string digest;  ///< SHA-256 of its file
  std::vector<model::ComponentName> components;
  friend bool operator==(const LibraryInfo&, const LibraryInfo&) = default;
};

/// A host's description of itself.
struct HostInfo {
  model::HostName name;
  std::string software;      ///< version of Segue
  std::string architecture;  ///< "x86_64"
  int pid = 0;               ///< of the daemon
  std::vector<LibraryInfo> libraries;
};

/// The lease of the runtime that commands a robot on a host.
struct LeaseInfo {
  std::string robot;
  std::string holder;       ///< names one run of a runtime: "HOST/PID/NUMBER"
  std::uint64_t epoch = 0;  ///< grows with every runtime that gets the robot
  Duration left{0};         ///< until another runtime may get it; 0: it may now
};

/// A component model file of the runtime's computer, for stand-ins.
struct ModelFile {
  std::string name;  ///< its last part, for messages
  std::string text;
};

/// Which output of a deployment process is wanted.
struct LogRequest {
  std::string robot;
  model::ProcessName process;
  std::size_t lines = 0;                               ///< the last ones
  std::optional<process_server::LogPosition> after{};  ///< instead: what was printed after this
};

/// The request of a runtime that wants to command a robot on a host.
struct RobotRequest {
  std::string holder;      ///< see LeaseInfo
  std::string secret{};    ///< of that run of the runtime, by which it gets its lease anew; never shown
  std::string identity{};  ///< who asks, as the server knows it: of its certificate; empty: of this computer
  process_server::Launch launch;  ///< for each process; without models, which lie on another computer
  std::vector<ModelFile> models;
  bool take_over = false;  ///< although another runtime has a lease that has not run out
  /// The runtime has had the robot here before, and is refused as Superseded if another one has had it since.
  bool again = false;
  /// The term of a runtime that has taken the robot over, the same on all hosts and in all its requests:
  /// higher than those of all runtimes before it (HostService::highest_term). 0: it has not taken it over.
  std::uint64_t term = 0;
};

/// The daemon of a computer (`segue host`), in this process (LocalHost) or elsewhere (control::connect_host).
/// Functions may be called from any thread.
class HostService {
 public:
  virtual ~HostService() = default;

  virtual Result<HostInfo> info() = 0;
  /// The host's wall clock now.
  virtual Result<std::chrono::system_clock::time_point> clock() = 0;
  /// Robots that have a lease or processes here, by name.
  virtual Result<std::vector<LeaseInfo>> robots() = 0;
  /// The output of a process here, whether or not it runs; at most 64 KiB of it where `after` is there, else
  /// 1 MiB. NotFound where there is none.
  virtual Result<process_server::LogPart> log(const LogRequest& request) = 0;
  /// The highest term of all runtimes that have had this robot here; 0 where none has.
  virtual Result<std::uint64_t> highest_term(const std::string& robot) = 0;
  /// Gives the caller the command of a robot on this host. AlreadyExists while another runtime has it (the
  /// message says which, and for how long at least), Superseded as RobotRequest::again says. Transitions that
  /// the former one had begun are given up. Superseded, too, where it takes the robot over from a runtime
  /// whose term is higher. Blocks until `deadline` at most: until actions that the former one had begun have
  /// ended.
  virtual Result<std::shared_ptr<HostedRobot>> acquire(const RobotRequest& request, TimePoint deadline) = 0;
};

}  // namespace segue::distributed
