// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission_run/implementation.hpp>

#include <algorithm>
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

/// The counts that the robot keeps of the mission's units, when a run begins.
Result<mission::UnitCounts> counts_of_robot(const mission::Mission& mission, const RunRequest& request) {
  mission::UnitCounts counts;
  const std::vector<std::string> names = mission::robot_units(mission);
  if (names.empty()) return counts;
  const auto of_robot = request.units ? request.units->counts() : Result<mission::UnitCounts>(counts);
  if (!of_robot) return of_robot.error();
  for (const std::string& name : names) {
    const bool is_given = request.resources.contains(name);
    const auto resource = std::ranges::find(mission.resources, name, &mission::Resource::name);
    if (!request.units && !is_given && resource->count == mission::Resource::kNoCount) {
      return fail(ErrorCode::InvalidArgument,
                  "the robot keeps the count of the resource " + quote(name) +
                      "; for a run without a robot the mission must say it ({of: robot, count: 3}), or "
                      "--resource " +
                      name + "=3");
    }
    if (!request.units) continue;
    if (is_given) {
      return fail(ErrorCode::InvalidArgument, "the robot keeps the count of the resource " + quote(name) +
                                                  "; `segue units set` changes it");
    }
    const auto found = std::ranges::find(*of_robot, name, [](const auto& one) { return one.first; });
    if (found != of_robot->end())
      counts.push_back(*found);
    else
      return fail(ErrorCode::NotFound,
                  "the robot keeps no units " + quote(name) +
                      ", which the mission asks for: its robot file must declare them, as "
                      "in `units: {" +
                      name + ": 3}`");
  }
  return counts;
}

}  // namespace

Result<mission::UnitObserver> follow_units(const mission::Mission& mission, const RunRequest& request,
                                           const RunJournal::Start& start, const RunJournal* journal) {
  const std::vector<std::string> names = mission::robot_units(mission);
  if (!request.units || names.empty()) return mission::UnitObserver();
  mission::UnitCounts begun;
  for (const auto& [name, count] : by_name(start.resources)) {
    if (std::ranges::find(names, name) != names.end()) begun.emplace_back(name, count);
  }
  if (auto begins = request.units->begin(journal != nullptr ? journal->run() : "", begun); !begins)
    return begins.error();
  return mission::UnitObserver([&mission, units = request.units](const mission::Execution& execution,
                                                                 const mission::UnitChanges& changes) {
    const auto of_robot = mission::changes_of_robot_units(mission, changes);
    if (!of_robot.empty()) units->changed(execution, of_robot);
  });
}

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
  const bool is_new = !request.journal || !request.journal->resume;
  if (is_new) {
    const auto counts = counts_of_robot(mission, request);
    if (!counts) return counts.error();
    start.resources.insert(start.resources.end(), counts->begin(), counts->end());
  }
  if (!request.journal) return start;
  const Journal& wanted = *request.journal;
  if (is_new) {
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
