// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/distributed/distributed_task_host.hpp>
#include <segue/model/robot.hpp>
#include <segue/rpc/endpoint.hpp>

#include <vector>

/// The computers that a robot file names.
namespace segue::runtime {

/// Whether deployments of the robot may live on other computers than the runtime's.
bool has_other_hosts(const model::Robot& robot);

/// How a host is reached. For TCP the certificates of its `credentials` are read, else those of this user.
Result<control::Endpoint> endpoint_of(const model::Robot& robot, const model::Host& host);

/// The other computers. Their certificates are read at each attempt to connect, so that they can be put right
/// while the robot runs.
std::vector<distributed::HostPlace> host_places(const model::Robot& robot);

/// Where samples travel: at the addresses of the hosts, in the DDS domain of $ROS_DOMAIN_ID. The runtime's
/// own computer, which Unix sockets lead to as well, has the address that leads to the first of the others
/// whose address is a number.
distributed::GatewaySettings gateway_settings(const model::Robot& robot);

/// The same addresses, of all hosts: where senders and receivers look for each other. It is enough that the
/// later of two processes knows the address of the earlier one, so an earlier one may have been started for
/// fewer hosts, or from another computer.
std::vector<std::string> peer_addresses(const model::Robot& robot);

}  // namespace segue::runtime
