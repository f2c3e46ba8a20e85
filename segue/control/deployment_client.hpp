// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/deploy/deployment_service.hpp>
#include <segue/process_server/process_service.hpp>
#include <segue/rpc/endpoint.hpp>

#include <filesystem>
#include <functional>
#include <memory>

namespace segue::control {

/// The deployment process on the other end of a socket. Waits for one that is still starting. InvalidState
/// where it is of another version (the error names both), Unsupported where something else is served there.
/// Fits fleet::Connector. Calls after it went answer Unavailable; those that it does not answer,
/// DeadlineExceeded: 2 s after their deadline, 10 s after their begin where they have none.
///
/// `gone` (may be null) and the service's listener are called from the connection's own thread. `gone` is
/// called at most once, and not where the service is destroyed, which waits for it: it must neither destroy
/// the service, call it, nor wait for another thread that does. Events that arrive faster than the listener
/// handles them are dropped, and their number is logged.
Result<deploy::ConnectedDeployment> connect_deployment(const std::filesystem::path& socket,
                                                       TimePoint deadline, std::function<void()> gone);

/// The process server of a computer (`segue host`) at that place; errors as of connect().
Result<std::unique_ptr<process_server::ProcessService>> connect_processes(
    const Endpoint& endpoint, Duration timeout = std::chrono::seconds(5));

}  // namespace segue::control
