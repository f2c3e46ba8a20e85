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
  std::string address;      ///< "local", "tcp://10.0.0.2:7447" or "unix:/run/segue/@host.sock"
  std::string credentials;  ///< folder of certificates, for TCP; empty: the user's own
  bool optional = false;    ///< the robot can be switched while it cannot be reached
  [[nodiscard]] bool is_local() const { return address == "local"; }
  friend bool operator==(const Host&, const Host&) = default;
};

struct RestartPolicy {
  int max = 3;  ///< attempts before giving up
  Duration backoff =
      std::chrono::milliseconds(100);  ///< before the first attempt; doubled for each further one
  friend bool operator==(const RestartPolicy&, const RestartPolicy&) = default;
};

/// Reactions of the runtime to faults.
struct Policies {
  FailurePolicy on_failure = FailurePolicy::Report;  ///< unless a task or deployment names another
  RestartPolicy restart;
  Duration watch = std::chrono::seconds(1);  ///< period of supervision, in addition to every event
  friend bool operator==(const Policies&, const Policies&) = default;
};

/// Resource limits of all standby controllers together.
struct LookAhead {
  int processes = 8;
  std::uint64_t memory = 2'000'000'000;  ///< bytes
  friend bool operator==(const LookAhead&, const LookAhead&) = default;
};

/// A robot file: its hosts, libraries, controllers and missions. Paths are relative to `folder`.
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
