// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc/detail/answer_later.hpp>
#include <segue/rpc_codecs/tasks_wire.hpp>
#include <segue/task_host/task_level.hpp>

#include <functional>
#include <stop_token>
#include <string>
#include <utility>

namespace segue::control::detail {

/// The question of a call of watch(). Throws WireError.
template <class Params>
task_host::LevelQuestion question_of(Params params) {
  task_host::LevelQuestion question{model::TaskId(as_string(params.getTask()))};
  if (params.hasSeen()) question.seen = decode(params.getSeen());
  question.each_update = params.getEachUpdate();
  return question;
}

/// Serves a call of watch() by `watch(question, wait, answered)`, as TaskHost::watch; `write` writes the
/// Level that `answered` gets to the results.
template <class Level, class Context, class Watch, class Write>
kj::Promise<void> answer_watch(Role needed, Caller& caller, Context context, Watch watch, Write write) {
  const auto params = context.getParams();
  return answer_later<Level>(
      needed, caller, context,
      [watch = std::move(watch), question = question_of(params),
       deadline = deadline_after(params.getTimeout())](const std::stop_token& dropped,
                                                       std::function<void(Result<Level>)> answered) {
        watch(question, Wait(deadline, dropped), std::move(answered));
      },
      write);
}

}  // namespace segue::control::detail
