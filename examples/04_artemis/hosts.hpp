// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/runtime/temporary_hosts.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace demo {

/// Several hosts on this computer, and the controllers of a robot with their processes dealt out to them.
/// They end with this object.
class Hosts {
 public:
  /// Starts `count` hosts, named a, b, ... Blocks until they can be reached.
  segue::Result<void> start(std::size_t count, const std::filesystem::path& robot_file);
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// The robot on these hosts.
  [[nodiscard]] std::filesystem::path robot_file() const { return robot_file_; }

 private:
  segue::runtime::TemporaryHosts hosts_;
  std::vector<std::string> names_;
  std::filesystem::path robot_file_;
};

}  // namespace demo
