// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/sample_link/shared_connection.hpp>

/// Establishes a connection between the two processes of a pair over a socket, to measure the link without
/// deployments. Trusts the other process.
namespace bench {

segue::Result<std::shared_ptr<segue::sample_link::SharedEndpoint>> connect_writer(
    segue::sample_link::SharedMemory& memory, int socket, segue::task::OutputPortBase& port,
    const segue::Policy& policy);
segue::Result<std::shared_ptr<segue::sample_link::SharedEndpoint>> connect_reader(
    segue::sample_link::SharedMemory& memory, int socket, segue::task::InputPortBase& port,
    const segue::Policy& policy);

}  // namespace bench
