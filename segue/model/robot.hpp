// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/error.hpp>
#include <segue/model/ids.hpp>
#include <segue/model/network.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace segue::model {

struct Host {
  HostName name;
  std::string address;  ///< "local" or "tcp://10.0.0.2:7447"
  std::string ca;       ///< certificate authority, for TCP
  [[nodiscard]] bool is_local() const { return address == "local"; }
  friend bool operator==(const Host&, const Host&) = default;
};

struct RestartPolicy {
  int max = 3;                                        ///< attempts until it is given up
  Duration backoff = std::chrono::milliseconds(100);  ///< before the first; doubled for each further one
  friend bool operator==(const RestartPolicy&, const RestartPolicy&) = default;
};

/// What the runtime does about differences between what shall run and what runs.
struct Policies {
  FailurePolicy on_failure = FailurePolicy::Report;  ///< where neither task nor deployment says
  RestartPolicy restart;
  Duration watch = std::chrono::seconds(1);  ///< how often it looks, besides at every event
  friend bool operator==(const Policies&, const Policies&) = default;
};

/// What controllers that are kept ready may use at most, all together.
struct LookAhead {
  int processes = 8;
  std::uint64_t memory = 2'000'000'000;  ///< bytes
  friend bool operator==(const LookAhead&, const LookAhead&) = default;
};

/// The file that names what a robot has. Paths are as in the file, relative to `folder`.
struct Robot {
  std::string name;
  std::vector<Host> hosts;
  std::vector<std::string> libraries;    ///< component libraries: names, never paths
  std::vector<std::string> models;       ///< component model files (patterns) beyond those of the libraries
  std::vector<std::string> controllers;  ///< network files (patterns)
  std::vector<std::string> missions;
  std::optional<NetworkName> fallback;
  Policies policies;
  LookAhead look_ahead;
  std::filesystem::path folder;
  SourceLocation where;
};

}  // namespace segue::model
