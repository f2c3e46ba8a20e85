// SPDX-License-Identifier: Apache-2.0
#include <segue/control/detail/server_core.hpp>
#include <segue/control/detail/wire.hpp>

#include <array>

namespace segue::control::detail {

namespace {

/// In the order of Served.
constexpr std::array<std::string_view, 4> kNouns = {"the robot", "the deployment process",
                                                    "the process server", "the host"};
constexpr std::array<std::string_view, 4> kKinds = {kRobotKind, kDeploymentKind, kProcessesKind, kHostKind};

}  // namespace

std::string_view ServerCore::noun() const {
  return kNouns.at(served.index());
}

std::string_view ServerCore::kind() const {
  return kKinds.at(served.index());
}

}  // namespace segue::control::detail
