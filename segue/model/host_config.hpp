// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::model {

/// The configuration file of a computer's daemon (`segue host`). Members that are empty have a default.
/// Relative paths are relative to the file.
struct HostConfig {
  std::string name;                   ///< what robot files call the computer
  std::string listen;                 ///< "0.0.0.0:7447"; empty: only the Unix socket
  std::filesystem::path credentials;  ///< folder with certificates (segue host enrol)
  std::filesystem::path state;        ///< folder for what outlives the daemon
  std::vector<std::string> zygote;    ///< component libraries that are loaded once for all processes
  friend bool operator==(const HostConfig&, const HostConfig&) = default;
};

/// Reads the configuration of a host's daemon; every problem becomes a diagnostic with its place, and if
/// there are errors, nothing is returned.
std::optional<HostConfig> read_host_config(std::string_view text, const std::string& file,
                                           Diagnostics& diagnostics);
std::optional<HostConfig> load_host_config(const std::filesystem::path& file, Diagnostics& diagnostics);

}  // namespace segue::model
