// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/question.hpp>
#include <segue/rpc/detail/rpc_channel.hpp>

#include <functional>
#include <string>
#include <utility>

namespace segue::control::detail {

/// Sends a question that the other side may answer at the end of the wait only, and returns at once.
/// `send(connection, left)` sends it in the channel's loop and returns a promise of a Result<T>. `answered`
/// is called once, by any thread, with Unavailable about `subject` where the connection is closed.
template <class T, class Send>
void ask_later(RpcChannel& channel, const Wait& wait, std::function<void(Result<T>)> answered, Send send,
               const std::string& subject = {}) {
  const SureAnswer<T> answer(std::move(answered),
                             fail(ErrorCode::Unavailable, "the connection is closed", subject));
  const Duration left = time_left(wait.deadline);
  auto begin = [left, answer, send = std::move(send)](RpcChannel::Connection& connection) {
    return send(connection, left).then([answer](Result<T>&& outcome) { answer(std::move(outcome)); });
  };
  channel.start(
      left + kGrace, std::move(begin), [answer](Error error) { answer(std::move(error)); }, wait.stop);
}

}  // namespace segue::control::detail
