// SPDX-License-Identifier: Apache-2.0
#include <segue/remote_robot/mission_record.hpp>

#include <algorithm>

namespace segue::remote_robot {

using type::Value;

namespace {

/// Bytes; longer texts are cut, so that a report stays small.
constexpr std::size_t kLongestText = 1024;

std::string cut(std::string_view text) {
  return std::string(text.substr(0, kLongestText));
}

std::int64_t nanoseconds(std::chrono::system_clock::time_point time) {
  return std::chrono::duration_cast<Duration>(time.time_since_epoch()).count();
}

}  // namespace

void MissionRecord::began(std::string_view mission, std::string_view mode) {
  const Lock lock(mutex_);
  mission_ = mission;
  begins_[{}] = RealClock::instance().now();
  add({.kind = "began", .mode = std::string(mode)});
}

void MissionRecord::observe(const mission::StateEvent& event) {
  if (event.path.empty()) return;  // the mission is that action, and has entries already
  const Lock lock(mutex_);
  std::string action(event.path);
  if (event.kind == mission::StateEvent::Kind::Began) {
    begins_[{action, event.iteration}] = RealClock::instance().now();
    return add({.kind = "began", .action = std::move(action), .iteration = event.iteration});
  }
  const Duration duration = since_begin_of(action, event.iteration);
  add({.kind = "ended",
       .action = std::move(action),
       .iteration = event.iteration,
       .outcome = cut(event.outcome),
       .error = cut(event.error),
       .duration = duration});
}

void MissionRecord::asked(const mission::ControllerRequest::Cause& cause) {
  const Lock lock(mutex_);
  if (cause.controller.empty()) return;
  add({.kind = "asked",
       .action = cause.action,
       .iteration = cause.iteration,
       .controller = cut(cause.controller)});
}

void MissionRecord::ended(std::string_view outcome, std::string_view error) {
  const Lock lock(mutex_);
  add({.kind = "ended", .outcome = cut(outcome), .error = cut(error), .duration = since_begin_of({}, 0)});
}

std::string MissionRecord::mission() const {
  const Lock lock(mutex_);
  return mission_;
}

/// Zero where its begin is not known.
Duration MissionRecord::since_begin_of(const std::string& action, std::uint64_t iteration) {
  const auto found = begins_.find({action, iteration});
  if (found == begins_.end()) return Duration::zero();
  const Duration duration = RealClock::instance().now() - found->second;
  begins_.erase(found);
  return duration;
}

void MissionRecord::add(Entry entry) {
  if (mission_.empty()) return;
  entry.number = ++last_number_;
  entry.time = std::chrono::system_clock::now();
  entry.action = cut(entry.action);
  waiting_.push_back(std::move(entry));
  if (waiting_.size() <= limits_.waiting) return;
  waiting_.pop_front();
  ++lost_;
}

Value MissionRecord::to_value(const Entry& entry) {
  Value value =
      Value::map({{"number", entry.number}, {"time_ns", nanoseconds(entry.time)}, {"kind", entry.kind}});
  type::ValueMap& map = value.as_map();
  if (!entry.action.empty()) {
    map.append("action", entry.action);
    map.append("iteration", entry.iteration);
  }
  if (!entry.mode.empty()) map.append("mode", entry.mode);
  if (!entry.controller.empty()) map.append("controller", entry.controller);
  if (entry.kind != "ended") return value;
  map.append("outcome", entry.outcome);
  map.append("duration_ns", entry.duration.count());
  if (!entry.error.empty()) map.append("error", entry.error);
  return value;
}

bool MissionRecord::has_waiting() const {
  const Lock lock(mutex_);
  return !waiting_.empty();
}

std::pair<Value, std::uint64_t> MissionRecord::waiting() const {
  const Lock lock(mutex_);
  if (waiting_.empty()) return {Value(), 0};
  Value::List entries;
  const std::size_t count = std::min(waiting_.size(), limits_.at_once);
  for (std::size_t i = 0; i < count; ++i)
    entries.push_back(to_value(waiting_[i]));
  return {Value::map({{"sent_ns", nanoseconds(std::chrono::system_clock::now())},
                      {"lost", lost_},
                      {"entries", std::move(entries)}}),
          waiting_[count - 1].number};
}

void MissionRecord::taken(std::uint64_t number) {
  const Lock lock(mutex_);
  while (!waiting_.empty() && waiting_.front().number <= number)
    waiting_.pop_front();
}

}  // namespace segue::remote_robot
