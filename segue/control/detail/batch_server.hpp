// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/tasks.capnp.h>
#include <segue/control/detail/caller.hpp>
#include <segue/deploy/task_access.hpp>

#include <memory>
#include <vector>

namespace segue::control::detail {

/// Who gets early reports of a client's batches; nobody until the client says who.
using Follower = std::shared_ptr<kj::Maybe<wire::BatchFollower::Client>>;

/// Has `tasks` carry out a batch for the caller, on threads of its own: a quick batch is
/// answered at once, and of a slow one the follower gets what has ended meanwhile. Only in the event loop.
kj::Promise<Result<std::vector<host::Completed>>> perform_batch(Caller caller,
                                                                std::shared_ptr<deploy::TaskAccess> tasks,
                                                                Follower follower, std::uint64_t ticket,
                                                                std::vector<model::Action> actions,
                                                                TimePoint deadline);

}  // namespace segue::control::detail
