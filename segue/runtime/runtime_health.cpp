// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/runtime_implementation.hpp>

#include <algorithm>
#include <iterator>

/// What is wrong with the robot, for whoever looks.
namespace segue::runtime {

using detail::DetectedFault;

/// What was requested and is not there; where nothing was, tasks that are broken.
std::vector<DetectedFault> Runtime::Implementation::faults_in(const model::Network& observed) const {
  const auto held = belief.held();
  if (held.wanted) {
    return detail::find_faults(detail::reachable_part(*held.wanted, host), observed,
                               options.policies.on_failure);
  }
  std::vector<DetectedFault> faults;
  for (const auto& task : without_pools(observed).tasks) {
    if (task.state == TaskState::Exception || task.state == TaskState::Fatal) {
      faults.push_back({task.id, model::FailurePolicy::Report, "is " + std::string(to_string(task.state))});
    }
  }
  return faults;
}

Look Runtime::Implementation::judge(task_host::TaskHost::View seen) {
  Look look{std::move(seen), host.computers(), {}, {}, {}};
  look.pools = report_pools(look.seen.tasks);
  const auto faults = faults_in(look.seen.network);
  const auto loss = host.loss();
  const bool requested = !open_requests().empty();
  const Lock lock(mutex);
  std::optional<std::string> failure;
  if (state == RuntimeState::Failed) {
    const bool known = !history.empty() && history.back().error;
    failure = known ? history.back().error->message : std::string();
  }
  look.health =
      detail::health_of({.in_transition = state == RuntimeState::Executing || requested || waiting_apply,
                         .lost = loss ? std::optional(to_string(*loss)) : std::nullopt,
                         .last_failure = std::move(failure),
                         .fallback = definitions.fallback,
                         .faults = faults,
                         .handled = handled,
                         .ended = ended,
                         .tasks = look.seen.tasks,
                         .computers = look.computers,
                         .pools = look.pools});
  trouble_times.note(look.health.troubles, std::chrono::system_clock::now());
  return look;
}

Look Runtime::Implementation::look() {
  Look look = judge(host.look());
  if (look.health.state != Health::State::InTransition) {
    look.differences = differences_from(look.seen.network, &look.seen.connections);
  }
  return look;
}

}  // namespace segue::runtime
