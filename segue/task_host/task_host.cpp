// SPDX-License-Identifier: Apache-2.0
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/task_host/ordered_actions.hpp>
#include <segue/task_host/task_host.hpp>

#include <utility>

namespace segue::task_host {

std::vector<Result<void>> wait_for_outcomes(std::size_t count, const std::function<void(Completion)>& begin) {
  struct Waiting {
    explicit Waiting(std::size_t count) : outcomes(count), left(count) {}
    Mutex mutex;
    ConditionVariable all_known;
    std::vector<Result<void>> outcomes SEGUE_GUARDED_BY(mutex);
    std::size_t left SEGUE_GUARDED_BY(mutex);
  };
  // Shared, since the waiter may be gone before the last call of the completion has returned.
  const auto waiting = std::make_shared<Waiting>(count);
  begin([waiting](std::vector<Completed> ended) {
    const Lock lock(waiting->mutex);
    for (auto& one : ended) {
      waiting->outcomes[one.index] = std::move(one.outcome);
    }
    waiting->left -= ended.size();
    if (waiting->left == 0) {
      waiting->all_known.notify_all();
    }
  });
  Lock lock(waiting->mutex);
  waiting->all_known.wait(waiting->mutex,
                          [&]() SEGUE_REQUIRES(waiting->mutex) { return waiting->left == 0; });
  return std::move(waiting->outcomes);
}

Result<void> TaskHost::can_make(const model::ComponentName& /*component*/) const {
  return {};
}

bool TaskHost::stands_in(const model::ComponentName& /*component*/) const {
  return false;
}

TaskHost::View TaskHost::snapshot() const {
  return {observe(), tasks(), connections()};
}

Diagnostics TaskHost::check(const model::Network& /*network*/) const {
  return {};
}

// NOLINTNEXTLINE(performance-unnecessary-value-param): those that override it keep them
void TaskHost::begin_all(std::vector<model::Action> actions, TimePoint deadline, Completion completed) {
  for (std::size_t i = 0; i < actions.size(); ++i) {
    const TimePoint begin = RealClock::instance().now();
    auto outcome = perform(actions[i], deadline);
    completed({{i, std::move(outcome), RealClock::instance().now() - begin}});
  }
}

std::vector<Result<void>> TaskHost::perform_all(std::span<const model::Action> actions, TimePoint deadline) {
  return wait_for_outcomes(actions.size(), [&](Completion completed) {
    begin_all({actions.begin(), actions.end()}, deadline, std::move(completed));
  });
}

void TaskHost::perform_in_order(std::vector<model::Action> actions, Duration action_deadline,
                                const EarlyEnd& early_end, Completion completed) {
  OrderedActions::Performer performer;
  performer.begin = [this](std::vector<model::Action> batch, TimePoint deadline, Completion ended) {
    begin_all(std::move(batch), deadline, std::move(ended));
  };
  performer.observe = [this] { return observe(); };
  std::make_shared<OrderedActions>(std::move(actions), action_deadline, std::move(performer),
                                   std::move(completed))
      ->run(early_end);
}

std::vector<ComputerReport> TaskHost::computers() const {
  return {};
}

model::Network TaskHost::expanded(model::Network network) const {
  return network;
}

model::Network TaskHost::condensed(model::Network network) const {
  return network;
}

void TaskHost::expect(const model::Network& /*target*/) {}

void TaskHost::begin_transition(const model::Network& /*before*/, const model::Network& target) {
  expect(target);
}

void TaskHost::get_ready(const model::Network& /*target*/) {}

Result<void> TaskHost::arm_commit(const model::Transition& /*transition*/, TimePoint /*deadline*/) {
  return {};
}

Result<void> TaskHost::commit() {
  return {};
}

void TaskHost::conclude(const model::Transition& /*transition*/) {}

void TaskHost::withdraw() {}

}  // namespace segue::task_host
