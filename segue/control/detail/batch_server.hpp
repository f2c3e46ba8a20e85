// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc_codecs/tasks.capnp.h>
#include <segue/rpc/detail/caller.hpp>
#include <segue/rpc_codecs/tasks_wire.hpp>
#include <segue/task_host/task_host.hpp>

#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace segue::control::detail {

/// The receiver of early reports of a client's batches; none until the client names one.
using Follower = std::shared_ptr<kj::Maybe<wire::BatchFollower::Client>>;

/// Lets a service begin a batch, without waiting for its end.
using BeginBatch = std::function<void(std::vector<model::Action> actions, task_host::Completion completed)>;

/// Has `begin` carry out a batch for the caller, on threads of the service: a quick batch is
/// answered at once, and of a slow one the follower gets what has ended meanwhile. Keeps `service` until
/// then. Only in the event loop.
kj::Promise<Result<std::vector<task_host::Completed>>> perform_batch(Caller caller,
                                                                     std::shared_ptr<void> service,
                                                                     Follower follower, std::uint64_t ticket,
                                                                     std::vector<model::Action> actions,
                                                                     const BeginBatch& begin);

/// The request of a call with `actions` and a `ticket`.
struct BatchRequest {
  std::uint64_t ticket = 0;
  std::vector<model::Action> actions{};
};
/// Throws WireError.
template <class Params>
BatchRequest batch_of(Params params) {
  return {params.getTicket(),
          decode_list<model::Action>(params.getActions(), [](const auto& part) { return decode(part); })};
}

/// Answers a call of `batch` by perform_batch().
template <class Context>
kj::Promise<void> answer_batch(Context context, BatchRequest batch, Caller caller,
                               std::shared_ptr<void> service, Follower follower, const BeginBatch& begin) {
  context.releaseParams();
  context.allowCancellation();
  return perform_batch(std::move(caller), std::move(service), std::move(follower), batch.ticket,
                       std::move(batch.actions), begin)
      .then([context](Result<std::vector<task_host::Completed>>&& outcomes) mutable {
        auto results = context.getResults();
        if (!outcomes) return encode(outcomes.error(), results.initError());
        try {
          encode_list(*outcomes, results.initEnded(count_of(*outcomes)),
                      [](const task_host::Completed& ended, auto builder) { encode(ended, builder); });
        } catch (const WireError& failed) {
          encode(failed.error(), results.initError());
        }
      });
}

}  // namespace segue::control::detail
