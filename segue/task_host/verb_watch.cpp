// SPDX-License-Identifier: Apache-2.0
#include <segue/task_host/verb_watch.hpp>

#include <utility>

namespace segue::task_host::detail {

namespace {

/// How long blocked tasks get, together, to become free: an update in progress is not a hook that hangs.
constexpr Duration kPatience = std::chrono::milliseconds(20);

}  // namespace

VerbWatch::Verb::Verb(VerbWatch& watch, model::TaskId id, const task::Task* task, std::string_view name,
                      TimePoint deadline)
    : watch_(watch), id_(std::move(id)), task_(task), name_(name), deadline_(deadline) {
  const Lock lock(watch_.mutex_);
  place_ = watch_.verbs_.insert(watch_.verbs_.end(), this);
}

VerbWatch::Verb::~Verb() {
  const Lock lock(watch_.mutex_);
  watch_.verbs_.erase(place_);
}

void VerbWatch::blocked(const model::TaskId& id, const std::shared_ptr<task::Task>& task) {
  const Lock lock(mutex_);
  blocked_.insert_or_assign(id, task);
}

std::vector<VerbWatch::Overdue> VerbWatch::overdue() {
  const TimePoint now = RealClock::instance().now();
  std::vector<Overdue> late;
  std::map<model::TaskId, std::weak_ptr<task::Task>> blocked;
  {
    const Lock lock(mutex_);
    for (const Verb* verb : verbs_) {
      if (verb->deadline_ < now) {
        late.push_back({verb->id_, verb->task_, verb->name_ + " has not returned by its deadline"});
      }
    }
    blocked = blocked_;
  }
  for (const auto& [id, weak] : blocked) {
    const auto task = weak.lock();
    if (task != nullptr && !task->settle(now + kPatience)) {
      late.push_back({id, task.get(), "a hook or an update has not returned"});
      continue;
    }
    const Lock lock(mutex_);
    blocked_.erase(id);
  }
  return late;
}

}  // namespace segue::task_host::detail
