// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/detail/answer_later.hpp>
#include <segue/control/detail/tasks_wire.hpp>
#include <segue/task_host/task_level.hpp>

#include <stop_token>
#include <string>
#include <utility>

namespace segue::control::detail {

/// The question of a call of watch(); an error where it has a word that this version does not know.
template <class Params>
Result<task_host::LevelQuestion> question_of(Params params) {
  task_host::LevelQuestion question{model::TaskId(as_string(params.getTask()))};
  try {
    if (params.hasSeen()) question.seen = decode(params.getSeen());
  } catch (const WireError& failed) {
    return failed.error();
  }
  question.each_update = params.getEachUpdate();
  return question;
}

/// Serves a call of watch() by `watch(question, wait, answered)`, as TaskHost::watch.
template <class Context, class Watch>
kj::Promise<void> answer_watch(Role needed, Caller& caller, Context context, Watch watch) {
  const auto params = context.getParams();
  return answer_later<task_host::TaskLevel>(
      needed, caller, context,
      [watch = std::move(watch), question = question_of(params),
       deadline = deadline_after(params.getTimeout())](const std::stop_token& dropped,
                                                       task_host::LevelAnswer answered) {
        if (!question) return answered(question.error());
        watch(*question, Wait(deadline, dropped), std::move(answered));
      },
      [](task_host::TaskLevel& level, auto results) { encode(level, results.initLevel()); });
}

}  // namespace segue::control::detail
