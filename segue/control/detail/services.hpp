// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc/detail/offered_service.hpp>

#include <memory>

namespace segue::deploy {
class DeploymentService;
}
namespace segue::process_server {
class ProcessService;
}
namespace segue::distributed {
class HostService;
}
namespace segue::control {
class RobotService;
}

/// The services of the protocol, each behind the server of its interface in a schema.
namespace segue::control::detail {

inline constexpr ServiceKind kRobotKind{"robot", "the robot"};
/// An offer of memory has two descriptors; no other message has any.
inline constexpr ServiceKind kDeploymentKind{"deployment", "the deployment process", 2};
inline constexpr ServiceKind kProcessesKind{"processes", "the process server"};
inline constexpr ServiceKind kHostKind{"host", "the host"};

std::unique_ptr<OfferedService> offer(RobotService& service);
std::unique_ptr<OfferedService> offer(deploy::DeploymentService& service);
std::unique_ptr<OfferedService> offer(process_server::ProcessService& service);
std::unique_ptr<OfferedService> offer(distributed::HostService& service);

}  // namespace segue::control::detail
