// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission_run/implementation.hpp>

#include <map>
#include <variant>

namespace segue::mission_run::detail {

using mission::RunJournal;

namespace {

Error changed(const std::string& what) {
  return fail(ErrorCode::InvalidArgument, "a run that is resumed goes on as it began, but " + what);
}

/// Of several counts of a resource the last one counts.
std::map<std::string, std::uint32_t> by_name(const mission::UnitCounts& counts) {
  std::map<std::string, std::uint32_t> found;
  for (const auto& [resource, count] : counts)
    found[resource] = count;
  return found;
}

/// An option that is given again for a run, as in the same command with `--resume`, must have the value that
/// the run began with.
Result<void> check_unchanged(const RunJournal::Start& wanted, const RunJournal::Start& begun) {
  for (const auto& [name, value] : wanted.inputs) {
    const type::Value* const before = begun.inputs.find(name);
    if (before != nullptr && *before == value) continue;
    return changed("the input " + quote(name) + " was " +
                   (before == nullptr ? "not given" : type::describe(*before)) + " and is " +
                   type::describe(value));
  }
  if (!wanted.facts.empty() && wanted.facts != begun.facts) return changed("its facts were others");
  if (!wanted.start_at.empty() && wanted.start_at != begun.start_at)
    return changed("it began at " + (begun.start_at.empty() ? "its start" : quote(begun.start_at)));
  if (wanted.seed != 0 && wanted.seed != begun.seed)
    return changed("its seed was " + std::to_string(begun.seed));
  const auto before = by_name(begun.resources);
  for (const auto& [resource, count] : by_name(wanted.resources)) {
    const auto found = before.find(resource);
    if (found != before.end() && found->second == count) continue;
    return changed("there are " + std::to_string(count) + " units of the resource " + quote(resource) +
                   (found == before.end() ? ", as many as the mission says then"
                                          : ", " + std::to_string(found->second) + " then"));
  }
  return {};
}

}  // namespace

Result<RunJournal::Start> open_journal(const mission::Mission& mission, const RunRequest& request,
                                       const mission::Runners& runners,
                                       std::shared_ptr<RunJournal>& journal) {
  const auto* const sequential = std::get_if<Sequential>(&request.mode);
  const bool concurrent = sequential == nullptr;
  RunJournal::Start start{request.inputs,
                          request.facts,
                          concurrent ? "" : sequential->start_at.value_or(""),
                          concurrent,
                          {request.resources.begin(), request.resources.end()},
                          request.seed.value_or(0)};
  if (!request.journal) return start;
  const Journal& wanted = *request.journal;
  if (!wanted.resume) {
    auto created = RunJournal::create(wanted.file, mission, start, request.note);
    if (!created) return created.error();
    journal = std::move(*created);
    return start;
  }
  const auto can_go_on = [&](const mission::Action& action, const type::Value& progress) {
    return runners.go_on(action, progress);
  };
  auto found = RunJournal::resume(wanted.file, mission, concurrent, *wanted.resume, request.note, can_go_on);
  if (!found) return found.error();
  if (auto same = check_unchanged(start, (*found)->start()); !same) return same.error();
  journal = std::move(*found);
  if (request.note) {
    request.note("the run is resumed: " + counted(journal->size(), "action") + " had ended");
  }
  return journal->start();
}

}  // namespace segue::mission_run::detail
