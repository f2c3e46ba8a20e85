// SPDX-License-Identifier: Apache-2.0
#include <segue/web/ros2_looks.hpp>

#include <segue/base/text.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string_view>

namespace segue::web {

namespace {

using type::Value;
using type::ValueMap;

/// Nodes are listened for some seconds, and those that do not answer hold up the look.
constexpr Duration kLookTime = std::chrono::seconds(60);
/// For what the robot's tasks say; those that have not answered then are left out.
constexpr Duration kTasksTime = std::chrono::seconds(10);
constexpr std::string_view kComponents = "ros2::";

std::optional<std::int64_t> domain_in(const Value* value) {
  constexpr std::int64_t kMostDomain = 232;
  if (value == nullptr || !value->is_number()) return std::nullopt;
  const double number = value->as_double();
  if (number < -1 || number > kMostDomain || number != std::floor(number)) return std::nullopt;
  return static_cast<std::int64_t>(number);
}

Result<std::optional<Ros2Place>> place_in(const Command& command) {
  const auto discovery = command.text_or("discovery", "");
  if (!discovery) return discovery.error();
  const Value* domain = command.arguments().find("domain");
  if (domain == nullptr && discovery->empty()) return std::optional<Ros2Place>();
  Ros2Place place{-1, *discovery};
  if (domain != nullptr) {
    const auto number = domain_in(domain);
    if (!number) return fail(ErrorCode::InvalidArgument, "'domain' must be an integer from -1 to 232");
    place.domain = *number;
  }
  return std::optional(std::move(place));
}

Value to_value(const Ros2Place& place) {
  return Value::map({{"domain", place.domain}, {"discovery", place.discovery}});
}

/// The robot's tasks that are of ROS 2, by id.
Result<ValueMap> tasks_of(control::RobotService& robot) {
  const TimePoint end = monotonic_now() + kTasksTime;
  const auto status = robot.status(Wait(end));
  if (!status) return status.error();
  ValueMap tasks;
  const Value* list = status->find("tasks");
  if (list == nullptr || !list->is_list()) return tasks;
  for (const Value& one : list->as_list()) {
    if (!one.find("component")->as_string().starts_with(kComponents)) continue;
    const std::string& id = one.find("id")->as_string();
    const auto report = monotonic_now() < end ? robot.task(id) : Result<Value>(no_longer_wanted());
    const Value* properties = report ? report->find("properties") : nullptr;
    ValueMap known;
    for (const char* name : {"domain", "discovery", "name", "node", "namespace"}) {
      const Value* value = properties == nullptr ? nullptr : properties->find(name);
      if (value != nullptr) known.set(name, *value);
    }
    tasks.set(id, std::move(known));
  }
  return tasks;
}

/// Each once, in the order of the tasks; the environment's where there are no tasks.
std::vector<Ros2Place> places_of(const ValueMap& tasks) {
  std::vector<Ros2Place> places;
  for (const auto& [id, task] : tasks) {
    const auto domain = domain_in(task.find("domain"));
    const Value* discovery = task.find("discovery");
    if (!domain || discovery == nullptr || !discovery->is_string()) continue;
    const Ros2Place place{*domain, discovery->as_string()};
    if (std::ranges::find(places, place) == places.end()) places.push_back(place);
  }
  if (places.empty()) places.emplace_back();
  return places;
}

}  // namespace

void Ros2Looks::begin(const Command& command, Answer answer) {
  if (!look_) return answer(fail(ErrorCode::Unsupported, "this studio does not look at ROS 2"));
  const auto asked = place_in(command);
  if (!asked) return answer(asked.error());
  if (!take_turn(*asked, std::move(answer))) return;
  const auto seen = look(*asked);
  std::vector<Answer> waiting;
  {
    const Lock lock(mutex_);
    waiting.swap(waiting_);
  }
  for (const Answer& one : waiting)
    one(seen);
}

bool Ros2Looks::take_turn(const Asked& asked, Answer answer) {
  {
    const Lock lock(mutex_);
    const bool is_first = waiting_.empty();
    if (is_first || asked == asked_) {
      asked_ = asked;
      waiting_.push_back(std::move(answer));
      return is_first;
    }
  }
  answer(
      fail(ErrorCode::Unavailable, "another domain of ROS 2 is being looked at; try again in some seconds"));
  return false;
}

Result<Value> Ros2Looks::look(const Asked& asked) {
  const auto link = link_.get();
  if (!link) return link.error();
  auto tasks = tasks_of(*link->robot);
  if (!tasks) {
    link_.failed(link->generation, tasks.error());
    return tasks.error();
  }
  const auto places = places_of(*tasks);
  const Ros2Place place = asked.value_or(places.front());
  if (std::ranges::find(places, place) == places.end())
    return fail(ErrorCode::NotFound, "no task of the robot is in domain " + std::to_string(place.domain) +
                                         (place.discovery.empty() ? "" : " (" + place.discovery + ")"));
  auto seen = look_(place, monotonic_now() + kLookTime);
  if (!seen) return seen;
  Value::List all;
  for (const Ros2Place& one : places)
    all.push_back(to_value(one));
  ValueMap& map = seen->as_map();
  map.set("place", to_value(place));
  map.set("places", std::move(all));
  map.set("tasks", std::move(*tasks));
  return seen;
}

}  // namespace segue::web
