// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/distributed/host_service.hpp>
#include <segue/rpc/endpoint.hpp>

#include <functional>
#include <memory>

namespace segue::control {

/// The daemon of a computer (`segue host`) at that place; errors as control::connect() says. To acquire a
/// robot needs the role Operate, to take it over Administer. Calls after it went answer Unavailable; those
/// that it does not answer in time, DeadlineExceeded. `gone` as for connect_deployment(); robots that were
/// acquired keep the connection.
Result<std::unique_ptr<distributed::HostService>> connect_host(const Endpoint& endpoint, TimePoint deadline,
                                                               std::function<void()> gone);

}  // namespace segue::control
