// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/recent_mission.hpp>

#include <segue/base/clock.hpp>

#include <algorithm>
#include <utility>

namespace segue::runtime::detail {

namespace {

using journal::MissionEntry;
using type::Value;

double since_1970(std::chrono::system_clock::time_point time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

Value entry_value(std::uint64_t number, const MissionEntry& entry) {
  Value value = Value::map({{"number", number},
                            {"time_s", since_1970(entry.time)},
                            {"kind", to_string(entry.kind)},
                            {"action", entry.action},
                            {"iteration", entry.iteration}});
  type::ValueMap& map = value.as_map();
  if (entry.kind == MissionEntry::Kind::Asked) map.append("controller", entry.controller);
  if (entry.kind != MissionEntry::Kind::Ended) return value;
  map.append("outcome", entry.outcome);
  map.append("duration_s", std::chrono::duration<double>(entry.duration).count());
  if (!entry.error.empty()) map.append("error", entry.error);
  return value;
}

Value state_in(const Value& doing) {
  const Value* state = doing.find("state");
  return state != nullptr && state->is_string() ? *state : Value("running");
}

Value control_in(const Value& doing) {
  const Value* control = doing.find("control");
  return control != nullptr && control->is_map() ? *control : Value();
}

}  // namespace

void RecentMission::add(const MissionEntry& entry) {
  if (entry.action.empty()) {
    if (entry.kind == MissionEntry::Kind::Began) {
      ++runs_;
      kept_.clear();
      dropped_ = 0;
      plan_ = Value();
    }
    last_ = entry;
  }
  kept_.push_back({++entries_, entry});
  if (kept_.size() <= kMostEntries) return;
  kept_.pop_front();
  ++dropped_;
}

void RecentMission::set_plan(Value plan) {
  plan_ = std::move(plan);
}

Value RecentMission::to_value(std::uint64_t after, bool with_plan, const Value& doing,
                              bool comes_to_rest) const {
  if (runs_ == 0) return {};
  const bool has_ended = last_.kind == MissionEntry::Kind::Ended;
  const Value ended_state(comes_to_rest ? "stopping" : "ended");
  Value::List entries;
  auto next = std::ranges::upper_bound(kept_, after, {}, &Numbered::number);
  for (; next != kept_.end() && entries.size() < kMostAtOnce; ++next)
    entries.push_back(entry_value(next->number, next->entry));
  Value value = Value::map({{"run", runs_},
                            {"mission", last_.mission},
                            {"who", last_.who},
                            {"state", has_ended ? ended_state : state_in(doing)},
                            {"control", has_ended ? Value() : control_in(doing)},
                            {"dropped", dropped_},
                            {"entries", std::move(entries)}});
  if (has_ended) {
    value.as_map().append("outcome", last_.outcome);
    value.as_map().append("error", last_.error);
  }
  if (with_plan) value.as_map().append("plan", plan_);
  return value;
}

}  // namespace segue::runtime::detail
