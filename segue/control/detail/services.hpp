// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/detail/caller.hpp>

/// The server's halves of the schemas: a service offered to one client. To be used in the event loop only.
namespace segue::control::detail {

capnp::Capability::Client make_robot_server(const Caller& caller);
capnp::Capability::Client make_deployment_server(const Caller& caller);
capnp::Capability::Client make_processes_server(const Caller& caller);

}  // namespace segue::control::detail
