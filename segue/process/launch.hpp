// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/base/shared_memory_options.hpp>
#include <segue/model/network.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace segue::process {

/// What a deployment process needs to know to begin. Handed over as JSON through an inherited descriptor.
struct Launch {
  std::string robot;
  model::Deployment deployment;        ///< tasks: empty
  std::vector<std::string> libraries;  ///< component libraries to load, by name
  std::vector<std::string> models;     ///< component model files for stand-ins, absolute paths
  bool stand_in = false;               ///< as host::LocalOptions
  bool only_stand_ins = false;
  std::string stand_ins;  ///< the text of a stand-in file; may be empty
  std::string log_level = "info";
  SharedMemoryOptions memory;

  friend bool operator==(const Launch& a, const Launch& b);
};

type::Value to_value(const Launch& launch);
/// InvalidArgument with the first entry that is wrong; entries that are missing keep their defaults, but
/// robot and process must be named.
Result<Launch> launch_from(const type::Value& value);

/// Where the processes of a robot have their sockets, logs and locks: `<control folder>/<robot>/`. Made with
/// mode 0700; refused where it belongs to somebody else. Names are checked: never a path.
Result<std::filesystem::path> process_folder(const std::string& robot);
/// `<process folder>/<process>.sock`; `<process>@<host>.sock` where the host is not called localhost.
Result<std::filesystem::path> process_socket(const std::string& robot, const model::DeploymentKey& key);
/// Whose socket it is, by its name; nothing where it is no process's.
std::optional<model::DeploymentKey> key_of_socket(const std::filesystem::path& socket);
/// Where the process of that socket prints: `<process>.log` beside it.
std::filesystem::path process_log(const std::filesystem::path& socket);

}  // namespace segue::process
