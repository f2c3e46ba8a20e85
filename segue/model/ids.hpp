// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/id.hpp>

#include <compare>
#include <cstddef>
#include <functional>
#include <string>

/// Components, networks, transitions and robots as plain values, and their files.
namespace segue::model {

using TaskId = Id<struct TaskIdTag>;            ///< unique in a network
using ComponentName = Id<struct ComponentTag>;  ///< "demo::Filter"
using HostName = Id<struct HostTag>;
using ProcessName = Id<struct ProcessTag>;
using NetworkName = Id<struct NetworkTag>;

/// The host every robot has: the computer of the runtime.
inline const HostName kLocalHost{"localhost"};

/// One end of a connection: "velodyne.scans".
struct PortRef {
  TaskId task;
  std::string port;
  friend bool operator==(const PortRef&, const PortRef&) = default;
  friend auto operator<=>(const PortRef&, const PortRef&) = default;
};
std::string to_string(const PortRef& ref);

/// The identity of a deployment: a process name on a host, independent of its tasks.
struct DeploymentKey {
  HostName host;
  ProcessName process;
  /// Tasks without a deployment live in the runtime's own process, which has the empty key.
  [[nodiscard]] bool is_runtime() const { return process.empty(); }
  friend bool operator==(const DeploymentKey&, const DeploymentKey&) = default;
  friend auto operator<=>(const DeploymentKey&, const DeploymentKey&) = default;
};
std::string to_string(const DeploymentKey& key);  ///< "host/process"

inline std::size_t combine_hashes(std::size_t a, std::size_t b) {
  return a ^ (b + 0x9e3779b97f4a7c15ULL + (a << 6) + (a >> 2));
}

}  // namespace segue::model

template <>
struct std::hash<segue::model::PortRef> {
  std::size_t operator()(const segue::model::PortRef& ref) const noexcept {
    return segue::model::combine_hashes(std::hash<segue::model::TaskId>{}(ref.task),
                                        std::hash<std::string>{}(ref.port));
  }
};

template <>
struct std::hash<segue::model::DeploymentKey> {
  std::size_t operator()(const segue::model::DeploymentKey& key) const noexcept {
    return segue::model::combine_hashes(std::hash<segue::model::HostName>{}(key.host),
                                        std::hash<segue::model::ProcessName>{}(key.process));
  }
};
