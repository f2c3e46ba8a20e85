// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/runtime/temporary_hosts.hpp>

#include "robot.hpp"

#include <string>
#include <vector>

namespace bench {

/// Where a host of a benchmark is.
struct Site {
  std::string name;
  std::string address = "127.0.0.1";    ///< a number
  std::vector<std::string> launcher{};  ///< starts the command that follows it there
};

/// Hosts that listen for commands as other computers do: at TCP ports, with certificates, besides a Unix
/// socket. They end with this object; any failure ends the program.
class Hosts {
 public:
  explicit Hosts(const std::vector<Site>& sites);

  /// The hosts as a robot file names them, reached over TCP and TLS, or by their Unix sockets.
  [[nodiscard]] segue::runtime::HostEntries over_tcp() const;
  [[nodiscard]] segue::runtime::HostEntries over_unix_sockets() const;

 private:
  [[nodiscard]] std::string keys(const std::string& name) const { return folder_.path() / name; }

  Scratch folder_;  ///< of keys
  std::vector<Site> sites_;
  std::vector<int> ports_;
  segue::runtime::TemporaryHosts hosts_;
};

}  // namespace bench
