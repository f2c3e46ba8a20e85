// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/question.hpp>
#include <segue/control/detail/rpc_channel.hpp>
#include <segue/control/detail/tasks_wire.hpp>
#include <segue/host/task_level.hpp>

#include <utility>

namespace segue::control::detail {

/// Sends a question for how a task is; `make` makes the request, in the channel's loop. As TaskHost::watch.
template <class Make>
void send_watch(RpcChannel& channel, const host::LevelQuestion& question, const Wait& wait,
                host::LevelAnswer answered, Make make) {
  const SureAnswer<host::TaskLevel> answer(
      std::move(answered), fail(ErrorCode::Unavailable, "the connection is closed", question.task.str()));
  const Duration left = time_left(wait.deadline);
  auto begin = [question, left, answer, make = std::move(make)](RpcChannel::Connection& connection) {
    auto request = make(connection);
    request.setTask(as_text(question.task.str()));
    if (question.seen) encode(*question.seen, request.initSeen());
    request.setEachUpdate(question.each_update);
    request.setTimeout(left.count());
    return RpcChannel::send<host::TaskLevel>(request,
                                             [](auto& results) { return decode(results.getLevel()); })
        .then([answer](Result<host::TaskLevel>&& level) { answer(std::move(level)); });
  };
  channel.start(
      left + kGrace, std::move(begin), [answer](Error error) { answer(std::move(error)); }, wait.stop);
}

}  // namespace segue::control::detail
