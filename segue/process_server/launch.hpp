// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/base/shared_memory_options.hpp>
#include <segue/model/network.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace segue::process_server {

/// How to begin a deployment process. It reaches the process as JSON through an inherited descriptor.
struct Launch {
  std::string robot;
  model::Deployment deployment;        ///< without tasks
  std::vector<std::string> libraries;  ///< names of the component libraries to load
  std::vector<std::string> models;     ///< absolute paths of component model files, for stand-ins
  bool stand_in = false;        ///< components that no library has are simulated (task_host::LocalOptions)
  bool only_stand_ins = false;  ///< all components are simulated
  std::string stand_ins;        ///< the content of a stand-in file; may be empty
  std::string log_level = "info";
  /// Addresses at which the robot's hosts exchange samples: $SEGUE_PEERS of the process, with commas between.
  std::vector<std::string> peers;
  SharedMemoryOptions memory;

  friend bool operator==(const Launch& a, const Launch& b);
};

type::Value to_value(const Launch& launch);
/// Missing entries keep their defaults, except for the names of robot and process, which are required.
/// InvalidArgument names the first entry that is wrong.
Result<Launch> launch_from(const type::Value& value);

/// The folder for the sockets, logs and locks of a robot's processes: `<control folder>/<robot>/`. Creates it
/// with mode 0700. InvalidArgument where the name is not a valid identifier (it might be a path),
/// PermissionDenied where the folder belongs to another user.
Result<std::filesystem::path> process_folder(const std::string& robot);
/// The socket of a process: `<process folder>/<process>.sock`, or `<process>@<host>.sock` for a host with
/// another name than localhost. Fails as process_folder().
Result<std::filesystem::path> process_socket(const std::string& robot, const model::DeploymentKey& key);
/// The process to which a socket belongs according to its file name; nothing where it is no such name.
std::optional<model::DeploymentKey> key_of_socket(const std::filesystem::path& socket);
/// The log of the process that has this socket: `<process>.log` beside it.
std::filesystem::path process_log(const std::filesystem::path& socket);

}  // namespace segue::process_server
