// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc/detail/ask_later.hpp>
#include <segue/rpc_codecs/tasks_wire.hpp>
#include <segue/task_host/task_level.hpp>

#include <utility>

namespace segue::control::detail {

/// Sends a question for how a task is; `make` makes the request, in the channel's loop. As TaskHost::watch.
template <class Make>
void send_watch(RpcChannel& channel, const task_host::LevelQuestion& question, const Wait& wait,
                task_host::LevelAnswer answered, Make make) {
  ask_later<task_host::TaskLevel>(
      channel, wait, std::move(answered),
      [question, make = std::move(make)](RpcChannel::Connection& connection, Duration left) {
        auto request = make(connection);
        request.setTask(as_text(question.task.str()));
        if (question.seen) encode(*question.seen, request.initSeen());
        request.setEachUpdate(question.each_update);
        request.setTimeout(left.count());
        return RpcChannel::send<task_host::TaskLevel>(
            request, [](auto& results) { return decode(results.getLevel()); });
      },
      question.task.str());
}

}  // namespace segue::control::detail
