// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/deployment.capnp.h>
#include <segue/control/detail/caller.hpp>

#include <memory>
#include <vector>

namespace segue::control::detail {

/// Whoever wants to know early how batches of a client go; may be nobody yet.
using Follower = std::shared_ptr<kj::Maybe<wire::BatchFollower::Client>>;

/// Carries out a batch by the caller's deployment service, without a thread of the pool: quick ones are
/// answered at once, and of slow ones the follower is told what has ended meanwhile. Only in the event loop.
kj::Promise<Result<std::vector<host::Completed>>> perform_batch(Caller caller, Follower follower,
                                                                std::uint64_t ticket,
                                                                std::vector<model::Action> actions,
                                                                TimePoint deadline);

}  // namespace segue::control::detail
