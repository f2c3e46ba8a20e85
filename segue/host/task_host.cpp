// SPDX-License-Identifier: Apache-2.0
#include <segue/host/task_host.hpp>

namespace segue::host {

Result<void> TaskHost::can_make(const model::ComponentName& /*component*/) const {
  return {};
}

Diagnostics TaskHost::check(const model::Network& /*network*/) const {
  return {};
}

void TaskHost::perform_all(std::span<const model::Action> actions, TimePoint deadline,
                           const Completion& completed) {
  for (std::size_t i = 0; i < actions.size(); ++i) {
    const TimePoint begin = RealClock::instance().now();
    auto outcome = perform(actions[i], deadline);
    completed({{i, std::move(outcome), RealClock::instance().now() - begin}});
  }
}

std::vector<Result<void>> TaskHost::perform_all(std::span<const model::Action> actions, TimePoint deadline) {
  std::vector<Result<void>> outcomes(actions.size());
  perform_all(actions, deadline, [&](std::vector<Completed> ended) {
    for (auto& one : ended) {
      outcomes[one.index] = std::move(one.outcome);
    }
  });
  return outcomes;
}

void TaskHost::expect(const model::Network& /*target*/) {}

void TaskHost::get_ready(const model::Network& /*target*/) {}

void TaskHost::conclude(const model::Transition& /*transition*/) {}

void TaskHost::withdraw() {}

}  // namespace segue::host
