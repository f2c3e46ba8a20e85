// SPDX-License-Identifier: Apache-2.0
#include <segue/web/hub.hpp>

#include <segue/base/text.hpp>
#include <segue/concurrent/thread.hpp>
#include <segue/type/json.hpp>
#include <segue/web/change.hpp>

#include <algorithm>
#include <optional>
#include <utility>

namespace segue::web {

namespace {

using type::Value;
using type::ValueMap;

/// The least time between two questions to the robot, however often something happens there.
constexpr Duration kShortestPause = std::chrono::milliseconds(20);
constexpr Duration kEventWait = std::chrono::seconds(1);
/// The number of entries of a mission in one answer from which on there are more.
constexpr std::size_t kManyEntries = 2000;
constexpr std::size_t kSampleBuffer = 1;  // only the newest is shown

/// Numbers, texts and the like in a sample.
std::size_t scalars_in(const Value& value) {
  if (value.is_list()) {
    std::size_t count = 0;
    for (const Value& item : value.as_list())
      count += scalars_in(item);
    return count;
  }
  if (value.is_map()) {
    std::size_t count = 0;
    for (const auto& [key, entry] : value.as_map())
      count += scalars_in(entry);
    return count;
  }
  return 1;
}

/// The status with its lists as maps.
Value with_keys(Value status) {
  if (!status.is_map()) return status;
  ValueMap& map = status.as_map();
  if (Value* tasks = map.find("tasks"); tasks != nullptr && tasks->is_list())
    *tasks = keyed(tasks->as_list(), {"id"});
  if (Value* connections = map.find("connections"); connections != nullptr && connections->is_list())
    *connections = keyed(connections->as_list(), {"from", "to", "policy"});
  return status;
}

/// Adds maps with a "number" beyond `last` by that number; of more than `most` the newest are kept.
void add_numbered(ValueMap& known, Value::List& fresh, std::uint64_t& last, std::size_t most) {
  if (fresh.empty()) return;
  ValueMap kept;
  const std::size_t room = most - std::min(most, fresh.size());
  std::size_t skip = known.size() - std::min(room, known.size());
  for (auto& [number, one] : known) {
    if (skip > 0) {
      --skip;
    } else {
      kept.append(number, std::move(one));
    }
  }
  for (std::size_t at = fresh.size() - std::min(fresh.size(), most); at < fresh.size(); ++at) {
    const Value* number = fresh[at].find("number");
    if (number == nullptr || !number->is_integer() || number->as_uint() <= last) continue;
    last = number->as_uint();
    kept.append(std::to_string(last), std::move(fresh[at]));
  }
  known = std::move(kept);
}

/// "port/TASK/PORT" -> TASK, PORT.
std::optional<std::pair<std::string, std::string>> port_of(std::string_view document) {
  constexpr std::string_view kPrefix = "port/";
  if (!document.starts_with(kPrefix)) return std::nullopt;
  const auto rest = document.substr(kPrefix.size());
  const auto slash = rest.find('/');
  if (slash == std::string_view::npos) return std::nullopt;
  const auto task = rest.substr(0, slash);
  const auto port = rest.substr(slash + 1);
  if (!is_identifier(task) || !is_identifier(port)) return std::nullopt;
  return std::pair(std::string(task), std::string(port));
}

std::optional<std::string> task_of(std::string_view document) {
  constexpr std::string_view kPrefix = "task/";
  if (!document.starts_with(kPrefix) || !is_identifier(document.substr(kPrefix.size()))) return std::nullopt;
  return std::string(document.substr(kPrefix.size()));
}

}  // namespace

/// A document that somebody looks at.
struct Hub::Watched {
  std::string name;
  Kind kind = kSnapshots;
  std::string task{};
  std::string port{};
  struct Looking {
    const Viewer* who;  ///< never used after its end
    std::weak_ptr<Viewer> viewer;
  };
  std::vector<Looking> viewers{};            ///< with the hub's mutex, as the next
  std::shared_ptr<const Document> newest{};  ///< null at first
  std::uint64_t generation = 0;              ///< from here on: used by the thread of this kind alone
  std::unique_ptr<control::SampleStream> stream{};
  std::uint64_t last_event = 0;  ///< or entry of a mission
  ValueMap events{};             ///< or entries of a mission
  std::uint64_t run = 0;         ///< of a mission
  Value plan{};
  Duration pause{};  ///< of a port: after each reading, for the size of its samples
  TimePoint next_read{};
  TimePoint heard{};  ///< the newest sample, or when the stream was opened
  Value rest{};       ///< of the mission, but for its plan and entries
};

Hub::Hub(RobotLink& link) : Hub(link, Periods{}) {}

Hub::Hub(RobotLink& link, Periods periods) : link_(link), periods_(periods) {
  for (const Kind kind : {kSnapshots, kPorts, kEvents})
    threads_[kind] = concurrent::start_thread("segue-hub", [this, kind] { run(kind); });
}

Hub::~Hub() {
  {
    const Lock lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_)
    thread.join();
}

Result<void> Hub::subscribe(const std::shared_ptr<Viewer>& viewer, const std::string& document) {
  const auto port = port_of(document);
  const auto task = task_of(document);
  if (!port && !task && document != "status" && document != "events" && document != "mission" &&
      document != "units")
    return fail(ErrorCode::NotFound, "there is no document " + quote(document));
  const Lock lock(mutex_);
  auto& entry = documents_[document];
  if (!entry) {
    if (documents_.size() > kMostDocuments) {
      documents_.erase(document);
      return fail(ErrorCode::ResourceExhausted, "too many documents are looked at");
    }
    entry = std::make_shared<Watched>();
    entry->name = document;
    entry->kind = port ? kPorts : document == "events" ? kEvents : kSnapshots;
    if (port) std::tie(entry->task, entry->port) = *port;
    if (task) entry->task = *task;
  }
  // No viewer may end with the mutex held, so none is kept alive here.
  const bool known =
      std::ranges::any_of(entry->viewers, [&](const auto& one) { return one.who == viewer.get(); });
  if (!known) entry->viewers.push_back({viewer.get(), viewer});
  ++nudges_;
  changed_.notify_all();
  return {};
}

void Hub::unsubscribe(const Viewer& viewer, const std::string& document) {
  std::shared_ptr<Watched> dropped;  // ends after the mutex is free, since a stream may have to be closed
  const Lock lock(mutex_);
  const auto found = documents_.find(document);
  if (found == documents_.end()) return;
  std::erase_if(found->second->viewers, [&](const auto& one) { return one.who == &viewer; });
  if (!found->second->viewers.empty()) return;
  dropped = std::move(found->second);
  documents_.erase(found);
}

void Hub::leave(const Viewer& viewer) {
  std::vector<std::string> names;
  {
    const Lock lock(mutex_);
    for (const auto& [name, entry] : documents_)
      names.push_back(name);
  }
  for (const std::string& name : names)
    unsubscribe(viewer, name);
}

std::shared_ptr<const Document> Hub::newest(const std::string& document) const {
  const Lock lock(mutex_);
  const auto found = documents_.find(document);
  return found == documents_.end() ? nullptr : found->second->newest;
}

std::vector<std::shared_ptr<Hub::Watched>> Hub::watched(Kind kind) const {
  std::vector<std::shared_ptr<Watched>> found;
  for (const auto& [name, entry] : documents_) {
    if (entry->kind == kind) found.push_back(entry);
  }
  return found;
}

void Hub::run(Kind kind) {
  const Duration period = kind == kPorts    ? periods_.ports
                          : kind == kEvents ? kShortestPause
                                            : periods_.snapshots;
  Lock lock(mutex_);
  while (!ends_) {
    auto due = watched(kind);
    if (due.empty()) {
      changed_.wait(mutex_);
      continue;
    }
    const std::uint64_t seen = nudges_;
    lock.unlock();
    for (const auto& document : due)
      refresh(*document);
    due.clear();  // what nobody looks at any more ends here
    lock.lock();
    changed_.wait_for(mutex_, kShortestPause, [this]() SEGUE_REQUIRES(mutex_) { return ends_; });
    changed_.wait_for(mutex_, period - std::min(period, kShortestPause),
                      [&]() SEGUE_REQUIRES(mutex_) { return ends_ || (kind != kEvents && nudges_ != seen); });
  }
}

void Hub::refresh(Watched& document) {
  const auto link = link_.get();
  if (!link) return publish(document, Value(), link.error().message);
  if (link->generation != document.generation) {
    document.generation = link->generation;
    document.stream.reset();
    document.next_read = {};
    document.last_event = 0;
    document.events = {};
    document.run = 0;
  }
  if (document.kind == kPorts && monotonic_now() < document.next_read) return;
  auto value = ask(document, *link);
  if (value && *value) return publish(document, std::move(**value), "");
  if (value) return;
  link_.failed(link->generation, value.error());
  document.stream.reset();
  publish(document, Value(), to_string(value.error()));
}

/// Whether what was published last is what the robot said last.
bool Hub::is_known(const Watched& document) const {
  const auto known = newest(document.name);
  return known && known->error.empty();
}

Hub::Answer Hub::ask(Watched& document, const RobotLink::Connected& link) {
  if (document.kind == kPorts) return read_port(document, link);
  if (document.kind == kEvents) return follow_events(document, link);
  if (document.name == "mission") return follow_mission(document, link);
  if (document.name == "units") {
    const auto units = link.robot->units();
    if (!units) return units.error();
    return Value::map({{"units", units->is_list() ? keyed(units->as_list(), {"name"}) : Value(ValueMap{})}});
  }
  auto snapshot = document.task.empty() ? link.robot->status() : link.robot->task(document.task);
  if (!snapshot) return snapshot.error();
  return document.task.empty() ? with_keys(std::move(*snapshot)) : std::move(*snapshot);
}

/// A stream that is silent is opened again: its task may have gone, or be another one of the same name by
/// now, of which the old stream would say nothing. Large samples are read less often, so that neither the
/// robot nor a browser is flooded.
Hub::Answer Hub::read_port(Watched& document, const RobotLink::Connected& link) {
  const TimePoint now = monotonic_now();
  if (!document.stream || now - document.heard > periods_.silence) {
    auto stream = link.robot->open_port(document.task, document.port, kSampleBuffer);
    if (!stream) return stream.error();
    document.stream = std::move(*stream);
    document.heard = now;
  }
  auto samples = document.stream->read(kSampleBuffer);
  if (!samples) return samples.error();
  document.next_read = now + document.pause;
  if (samples->empty()) return is_known(document) ? std::nullopt : std::optional(Value());
  document.heard = now;
  using Seconds = std::chrono::duration<double>;
  const Seconds least(static_cast<double>(scalars_in(samples->back())) / periods_.scalars_per_second);
  document.pause = std::chrono::duration_cast<Duration>(least);
  document.next_read = now + document.pause;
  return Value::map({{"type", document.stream->type_name()},
                     {"time_s", Seconds(now.time_since_epoch()).count()},
                     {"period_s", std::max(least, Seconds(periods_.ports)).count()},
                     {"value", std::move(samples->back())}});
}

/// Follows the mission that runs now, even if another one did at the last question.
Hub::Answer Hub::follow_mission(Watched& document, const RobotLink::Connected& link) {
  Value rest;
  bool has_news = !is_known(document);
  std::size_t fresh = 0;
  do {
    const bool wants_plan = document.plan.is_null() || document.plan.find("outline") != nullptr;
    auto mission = link.robot->mission(document.last_event, wants_plan);
    if (!mission) return mission.error();
    if (mission->is_null()) return Value::map({{"run", 0}});
    const Value* run = mission->find("run");
    Value* entries = mission->is_map() ? mission->as_map().find("entries") : nullptr;
    if (run == nullptr || !run->is_integer() || entries == nullptr || !entries->is_list())
      return fail(ErrorCode::Internal, "the robot sent a mission without entries");
    if (run->as_uint() != document.run) {
      document.run = run->as_uint();
      document.events = {};
      document.plan = Value();
    }
    if (Value* plan = mission->as_map().find("plan"); plan != nullptr && !plan->is_null()) {
      has_news = has_news || *plan != document.plan;
      document.plan = std::move(*plan);
    }
    fresh = entries->as_list().size();
    has_news = has_news || fresh > 0;
    add_numbered(document.events, entries->as_list(), document.last_event, kMostMissionEntries);
    mission->as_map().erase("plan");
    mission->as_map().erase("entries");
    rest = std::move(*mission);
  } while (fresh >= kManyEntries);
  if (!has_news && rest == document.rest) return std::nullopt;
  document.rest = rest;
  rest.as_map().set("plan", document.plan);
  rest.as_map().set("entries", document.events);
  return rest;
}

Hub::Answer Hub::follow_events(Watched& document, const RobotLink::Connected& link) {
  auto events = link.robot->events(document.last_event, document.last_event == 0 ? Duration(0) : kEventWait);
  if (!events) return events.error();
  if (!events->is_list()) return fail(ErrorCode::Internal, "the robot sent events that are not a list");
  auto& fresh = events->as_list();
  const bool has_news = !fresh.empty();
  add_numbered(document.events, fresh, document.last_event, kMostEvents);
  if (has_news) {
    const Lock lock(mutex_);
    ++nudges_;
    changed_.notify_all();
  }
  if (!has_news && is_known(document)) return std::nullopt;
  return Value(document.events);
}

void Hub::publish(Watched& document, Value value, std::string error) {
  const auto before = newest(document.name);
  if (before && before->error == error && (!error.empty() || before->value == value)) return;
  auto next = std::make_shared<Document>();
  next->version = before ? before->version + 1 : 1;
  next->error = std::move(error);
  // The last known value stays, so that a page can show it until the robot answers again.
  if (next->error.empty() || !before)
    next->value = std::move(value);
  else
    next->value = before->value;
  if (before && before->value.is_map() && next->value.is_map())
    next->change = type::to_json(change_between(before->value, next->value), -1);
  std::vector<std::shared_ptr<Viewer>> told;
  {
    const Lock lock(mutex_);
    document.newest = std::move(next);
    for (const auto& looking : document.viewers) {
      if (auto alive = looking.viewer.lock()) told.push_back(std::move(alive));
    }
  }
  for (const auto& viewer : told)
    viewer->on_change(document.name);
}

}  // namespace segue::web
