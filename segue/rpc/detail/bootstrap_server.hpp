// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc/detail/caller.hpp>

#include <functional>
#include <memory>

namespace segue::control::detail {

/// The first object that a client reaches. Accepts clients of the same protocol version that request the
/// service which is offered. `enter` tells whether there is a place for the client, and takes it. Only in the
/// event loop.
wire::Bootstrap::Client make_bootstrap(ServerCore& core, std::shared_ptr<ClientState> client,
                                       std::function<bool()> enter);

}  // namespace segue::control::detail
