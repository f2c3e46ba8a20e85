// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/question.hpp>
#include <segue/rpc/detail/caller.hpp>

#include <stop_token>
#include <string>
#include <utility>

namespace segue::control::detail {

/// For a service that answers later, which takes none of the pool's threads: calls `begin(stop, answered)`,
/// where `stop` says that the client has dropped the call and `answered`, which takes a Result<T>, must be
/// called once, by any thread; then as Caller::answer(). `begin` must not block.
template <class T, class Context, class Begin, class Reply>
kj::Promise<void> answer_later(Role needed, Caller& caller, Context context, Begin begin, Reply reply) {
  using Fulfiller = kj::Own<kj::PromiseFulfiller<Result<T>>>;
  ServerCore& core = caller.core();
  auto pair = kj::newPromiseAndFulfiller<Result<T>>();
  auto refused = caller.require(needed);
  if (refused) refused = caller.begin_watch();
  if (!refused) {
    Result<T> outcome(refused.error());
    write_outcome(outcome, context.getResults(), reply);
    return kj::READY_NOW;
  }
  context.releaseParams();
  context.allowCancellation();
  std::stop_source dropped;
  // Destroyed in the loop's thread; the server does not end before it has been answered.
  auto* fulfiller = new Fulfiller(kj::mv(pair.fulfiller));
  core.watches.add();
  const SureAnswer<T> answered(
      [&core, fulfiller](Result<T> outcome) {
        core.loop.post([fulfiller, outcome = std::move(outcome)](kj::AsyncIoContext&) mutable {
          (*fulfiller)->fulfill(std::move(outcome));
          delete fulfiller;
        });
        core.watches.remove();
      },
      fail(ErrorCode::Internal, std::string(core.noun()) + " did not answer"));
  auto ended = kj::defer([client = caller.client(), dropped]() mutable {
    --client->watches;
    dropped.request_stop();
  });
  try {
    begin(dropped.get_token(), answered);
  } catch (...) {
    answered(thrown_by_service(core.noun()));
  }
  return pair.promise
      .then([context, reply = std::move(reply)](Result<T>&& outcome) mutable {
        write_outcome(outcome, context.getResults(), reply);
      })
      .attach(kj::mv(ended));
}

}  // namespace segue::control::detail
