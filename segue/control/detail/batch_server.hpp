// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/deployment.capnp.h>
#include <segue/control/detail/caller.hpp>

#include <memory>
#include <vector>

namespace segue::control::detail {

/// Who gets early reports of a client's batches; nobody until the client says who.
using Follower = std::shared_ptr<kj::Maybe<wire::BatchFollower::Client>>;

/// Has the caller's deployment service carry out a batch, on threads of the service: a quick batch is
/// answered at once, and of a slow one the follower gets what has ended meanwhile. Only in the event loop.
kj::Promise<Result<std::vector<host::Completed>>> perform_batch(Caller caller, Follower follower,
                                                                std::uint64_t ticket,
                                                                std::vector<model::Action> actions,
                                                                TimePoint deadline);

}  // namespace segue::control::detail
