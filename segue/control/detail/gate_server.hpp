// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/detail/caller.hpp>

#include <cstddef>
#include <functional>
#include <memory>

namespace segue::control::detail {

/// How many clients may have said hello at a time.
inline constexpr std::size_t kMaxClients = 64;

/// What a client reaches first. Accepts clients of the same protocol version that request the service which
/// is offered. `clients` tells how many have been accepted and are connected. Only in the event loop.
wire::Gate::Client make_gate(ServerCore& core, std::shared_ptr<ClientState> client,
                             std::function<std::size_t()> clients);

}  // namespace segue::control::detail
