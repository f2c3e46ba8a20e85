// SPDX-License-Identifier: Apache-2.0
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/task_host/task_access.hpp>
#include <segue/task_host/task_forwarder.hpp>

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

std::vector<Completed> all_failed(std::size_t count, const Error& why) {
  std::vector<Completed> ended;
  for (std::size_t index = 0; index < count; ++index) {
    ended.push_back({index, why});
  }
  return ended;
}

std::vector<Result<void>> TaskAccess::perform_all(std::span<const model::Action> actions, Deadline deadline) {
  return wait_for_outcomes(actions.size(), [&](Completion completed) {
    begin_all({actions.begin(), actions.end()}, deadline, std::move(completed));
  });
}

Result<void> hand_over_state(const TaskPlace& from, const TaskPlace& to, TimePoint deadline) {
  const auto state = from.tasks->save_state(from.task, deadline);
  if (!state) {
    return state.error();
  }
  return state->has_value() ? to.tasks->restore_state(to.task, **state, deadline) : Result<void>();
}

}  // namespace segue::task_host
