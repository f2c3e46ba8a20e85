// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/transition_execution.hpp>

#include <segue/task_host/early_end.hpp>

#include <utility>

namespace segue::runtime::detail {

Execution::Execution(task_host::TaskHost& host, const model::Transition& transition, Duration action_deadline,
                     TimePoint started, Progress progress, std::shared_ptr<LeftActions> left)
    : host_(host),
      action_deadline_(action_deadline),
      progress_(std::move(progress)),
      left_(std::move(left)),
      started_(started) {
  records_.reserve(transition.actions.size());
  for (const auto& action : transition.actions) {
    records_.push_back({action, {}, {}, std::nullopt, false});
  }
}

bool Execution::run(model::Phase phase) {
  Indices indices;
  std::vector<model::Action> actions;
  Lock lock(mutex_);
  for (std::size_t index = 0; index < records_.size(); ++index) {
    if (records_[index].action.phase == phase) {
      indices.push_back(index);
      actions.push_back(records_[index].action);
    }
  }
  if (!actions.empty() && !stop_.stop_requested()) {
    lock.unlock();
    const TimePoint begin = RealClock::instance().now();
    host_.perform_in_order(
        std::move(actions), action_deadline_,
        {stop_.get_token(), &leaving_, [left = left_](const model::Action& action) { left->ended(action); }},
        [self = shared_from_this(), indices = std::move(indices), since = begin - started_](
            std::vector<task_host::Completed> ended) { self->complete(indices, since, std::move(ended)); });
    const Duration took = RealClock::instance().now() - begin;
    lock.lock();
    windows_.at(static_cast<std::size_t>(phase)) = took;
  }
  return failed_ == kNobody && !stop_.stop_requested();
}

void Execution::leave(const task_host::Leaving::MayBeLeft& may_be_left) {
  stop_.request_stop();
  leaving_.leave([&](const model::Action& action) {
    const bool leaves = may_be_left(action);
    if (leaves) {
      left_->add(action);
    }
    return leaves;
  });
}

void Execution::complete(const Indices& indices, Duration begin, std::vector<task_host::Completed> ended) {
  const Lock lock(mutex_);
  for (auto& one : ended) {
    if (!one.begun) {
      continue;
    }
    const std::size_t index = indices[one.index];
    ActionRecord& record = records_[index];
    record.started = begin + one.span->begin;
    record.duration = one.span->end - one.span->begin;
    record.took = one.took;
    record.executed = true;
    if (!one.outcome) {
      record.error = std::move(one.outcome.error());
      failed_ = failed_ == kNobody ? index : failed_;
    }
    progress_(record);
  }
}

std::vector<ActionRecord> Execution::take_records() {
  const Lock lock(mutex_);
  return std::move(records_);
}

const ActionRecord* Execution::failure() const {
  const Lock lock(mutex_);
  return failed_ == kNobody ? nullptr : &records_[failed_];
}

Duration Execution::window(model::Phase phase) const {
  const Lock lock(mutex_);
  return windows_.at(static_cast<std::size_t>(phase));
}

}  // namespace segue::runtime::detail
