// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/detail/caller.hpp>

/// The servers of the schemas' interfaces: each offers a service to one client. Only for use in the event
/// loop.
namespace segue::control::detail {

capnp::Capability::Client make_robot_server(const Caller& caller);
capnp::Capability::Client make_deployment_server(const Caller& caller);
capnp::Capability::Client make_processes_server(const Caller& caller);
capnp::Capability::Client make_host_server(const Caller& caller);

}  // namespace segue::control::detail
