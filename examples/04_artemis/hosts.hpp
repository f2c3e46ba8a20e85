// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace demo {

/// Several hosts on this computer: a daemon each (`segue host`), with folders of its own, and the controllers
/// of a robot with their processes dealt out to them. The destructor ends the daemons and removes the
/// folders.
class Hosts {
 public:
  Hosts() = default;
  ~Hosts();
  Hosts(const Hosts&) = delete;
  Hosts& operator=(const Hosts&) = delete;

  /// Starts `count` hosts, named a, b, ... Blocks until they can be reached.
  segue::Result<void> start(std::size_t count, const std::filesystem::path& robot_file);
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// The robot on these hosts.
  [[nodiscard]] std::filesystem::path robot_file() const { return folder_ / "robot" / "robot.yaml"; }

 private:
  segue::Result<void> start_daemon(const std::string& name);
  segue::Result<void> deal_out(const std::filesystem::path& robot_file) const;

  std::filesystem::path folder_;
  std::vector<std::string> names_;
  std::vector<pid_t> daemons_;
};

}  // namespace demo
