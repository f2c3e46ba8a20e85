// SPDX-License-Identifier: Apache-2.0
#include <segue/session/implementation.hpp>

namespace segue::session::detail {

using mission::RunJournal;

Result<RunJournal::Start> open_journal(const mission::Mission& mission, const RunRequest& request,
                                       std::shared_ptr<RunJournal>& journal) {
  const bool concurrent = request.mode == RunMode::Concurrent;
  RunJournal::Start start{request.inputs, request.facts,     request.start_at,
                          concurrent,     request.resources, request.seed};
  if (!request.journal) return start;
  const JournalRequest& wanted = *request.journal;
  if (!wanted.resume) {
    auto created = RunJournal::create(wanted.file, mission, start, request.note);
    if (!created) return created.error();
    journal = std::move(*created);
    return start;
  }
  const bool is_new = !start.inputs.empty() || !start.facts.empty() || !start.start_at.empty() ||
                      !start.resources.empty() || start.seed != 0;
  if (is_new) {
    return fail(ErrorCode::InvalidArgument,
                "a run that is resumed has the inputs, facts, resources, seed and start that it began with");
  }
  const auto can_go_on = [&](const mission::Action& action, const type::Value& progress) {
    return request.runners.go_on(action, progress);
  };
  auto found =
      RunJournal::resume(wanted.file, mission, concurrent, wanted.under_way, request.note, can_go_on);
  if (!found) return found.error();
  journal = std::move(*found);
  if (request.note) {
    request.note("the run is resumed: " + std::to_string(journal->size()) +
                 (journal->size() == 1 ? " action" : " actions") + " had ended");
  }
  return journal->start();
}

}  // namespace segue::session::detail
