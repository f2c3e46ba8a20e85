// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc/detail/ask_later.hpp>
#include <segue/rpc_codecs/tasks_wire.hpp>
#include <segue/task_host/task_level.hpp>

#include <functional>
#include <utility>

namespace segue::control::detail {

/// Sends a question for how a task is, as TaskHost::watch. `make` makes the request and `read` a Level of its
/// results, both in the channel's loop.
template <class Level, class Make, class Read>
void send_watch(RpcChannel& channel, const task_host::LevelQuestion& question, const Wait& wait,
                std::function<void(Result<Level>)> answered, Make make, Read read) {
  ask_later<Level>(
      channel, wait, std::move(answered),
      [question, make = std::move(make), read](RpcChannel::Connection& connection, Duration left) {
        auto request = make(connection);
        request.setTask(as_text(question.task.str()));
        if (question.seen) encode(*question.seen, request.initSeen());
        request.setEachUpdate(question.each_update);
        request.setTimeout(left.count());
        return RpcChannel::send<Level>(request, read);
      },
      question.task.str());
}

}  // namespace segue::control::detail
