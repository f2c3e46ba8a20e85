// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace segue::testing {

/// A network of name spaces, one for each station, that fails as it is told to (impaired_wire). Only root may
/// make one; it and everything mounted by the test's process ends with the process, however that ends.
class TestNetwork {
 public:
  /// Empty, or why there can be none here. The first call makes name spaces for mounts, and must come before
  /// other threads are started.
  static const std::string& obstacle();

  explicit TestNetwork(const std::vector<std::string>& stations);
  ~TestNetwork();
  TestNetwork(const TestNetwork&) = delete;
  TestNetwork& operator=(const TestNetwork&) = delete;

  /// What starts a command, which follows it, in the name space of a station.
  [[nodiscard]] static std::vector<std::string> launcher(const std::string& station);
  [[nodiscard]] std::string address(const std::string& station) const;

  /// Has the network do what a line says (tests/wire/command.hpp). Returns what is answered besides `ok`.
  std::string say(const std::string& line);

 private:
  std::string answer();

  const std::vector<std::string> stations_;
  pid_t wire_ = -1;
  int commands_ = -1;
  int answers_ = -1;
  std::string read_;
};

}  // namespace segue::testing
