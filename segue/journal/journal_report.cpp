// SPDX-License-Identifier: Apache-2.0
#include <segue/base/clock.hpp>
#include <segue/journal/journal_report.hpp>

namespace segue::journal {

namespace {

using type::Value;

double seconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

Value action_value(const ActionEntry& action) {
  Value value = Value::map({{"id", action.id},
                            {"kind", to_string(action.kind)},
                            {"phase", to_string(action.phase)},
                            {"label", action.label},
                            {"component", action.component},
                            {"host", action.host.str()},
                            {"process", action.process.str()},
                            {"started_s", seconds(action.started)},
                            {"waited_s", seconds(action.waited)},
                            {"duration_s", seconds(action.duration)},
                            {"outcome", action.outcome}});
  if (action.ended) value.as_map().set("ended_s", seconds(*action.ended));
  if (!action.error.empty()) value.as_map().set("error", action.error);
  return value;
}

}  // namespace

Value to_value(const model::DurationRange& range) {
  return Value::map(
      {{"low", seconds(range.low)}, {"typical", seconds(range.typical)}, {"high", seconds(range.high)}});
}

Value to_value(const Prediction& prediction) {
  return Value::map({{"total", to_value(prediction.total)}, {"commit", to_value(prediction.commit)}});
}

Value to_value(const PreparedAhead& ahead, Duration prepare) {
  return Value::map({{"tasks", static_cast<std::uint64_t>(ahead.tasks)},
                     {"unprepared_s", seconds(ahead.unprepared)},
                     {"saved_s", seconds(ahead.saved(prepare))}});
}

Value to_value(const TransitionEntry& entry) {
  Value value = Value::map({{"outcome", entry.outcome},
                            {"cause", entry.cause},
                            {"request", entry.request},
                            {"who", entry.who},
                            {"time", iso_time(entry.time)},
                            {"from", entry.from},
                            {"to", entry.to},
                            {"runs", entry.runs},
                            {"from_version", entry.from_version},
                            {"to_version", entry.to_version},
                            {"runs_version", entry.runs_version},
                            {"order", entry.order},
                            {"solve_s", seconds(entry.solve)},
                            {"duration_s", seconds(entry.total)},
                            {"prepare_s", seconds(entry.prepare)},
                            {"commit_s", seconds(entry.commit)},
                            {"retire_s", seconds(entry.retire)}});
  type::ValueMap& map = value.as_map();
  if (entry.predicted) map.set("predicted_s", to_value(*entry.predicted));
  if (entry.ahead) map.set("ahead", to_value(*entry.ahead, entry.prepare));
  if (!entry.undone.empty()) map.set("undone", entry.undone);
  if (!entry.cancelled_by.empty()) map.set("cancelled_by", entry.cancelled_by);
  if (!entry.error.empty()) map.set("error", entry.error);
  Value::List actions;
  for (const ActionEntry& action : entry.actions)
    actions.push_back(action_value(action));
  map.set("actions", std::move(actions));
  Value::List undo_actions;
  for (const ActionEntry& action : entry.undo_actions)
    undo_actions.push_back(action_value(action));
  map.set("undo_actions", std::move(undo_actions));
  return value;
}

Value to_value(const DifferenceEntry& entry) {
  return Value::map({{"time", iso_time(entry.time)},
                     {"subject", entry.subject},
                     {"sentence", entry.sentence},
                     {"done", entry.done}});
}

Value to_value(const VersionEntry& entry) {
  return Value::map({{"time", iso_time(entry.time)},
                     {"controller", entry.controller},
                     {"version", entry.version},
                     {"file", entry.file},
                     {"text", entry.text}});
}

Value to_value(const MissionEntry& entry) {
  Value value = Value::map({{"time", iso_time(entry.time)},
                            {"kind", to_string(entry.kind)},
                            {"who", entry.who},
                            {"mission", entry.mission}});
  type::ValueMap& map = value.as_map();
  if (!entry.action.empty()) {
    map.set("action", entry.action);
    map.set("iteration", entry.iteration);
  }
  if (!entry.mode.empty()) map.set("mode", entry.mode);
  if (entry.kind == MissionEntry::Kind::Asked) map.set("controller", entry.controller);
  if (entry.kind != MissionEntry::Kind::Ended) return value;
  map.set("outcome", entry.outcome);
  map.set("duration_s", seconds(entry.duration));
  if (!entry.error.empty()) map.set("error", entry.error);
  return value;
}

Value to_value(const GapEntry& entry) {
  return Value::map({{"time", iso_time(entry.time)}, {"lost", entry.lost}, {"reason", entry.reason}});
}

}  // namespace segue::journal
