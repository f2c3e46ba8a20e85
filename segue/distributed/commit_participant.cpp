// SPDX-License-Identifier: Apache-2.0
#include <segue/distributed/commit_participant.hpp>

#include <segue/base/rounded_text.hpp>
#include <segue/base/text.hpp>
#include <segue/task_host/ordered_actions.hpp>

#include <algorithm>
#include <atomic>
#include <utility>

namespace segue::distributed {

namespace {

/// How long a link may take to answer, besides the wait itself.
constexpr Duration kAnswering = std::chrono::seconds(2);
/// The most waits at the same time, far fewer than the calls that a process takes from one client. Links find
/// each other without being asked, so the order of the waits makes no difference.
constexpr std::size_t kMostWaits = 4;

}  // namespace

Result<HostView> CommitParticipant::snapshot() {
  return tasks_.snapshot();
}

Result<void> CommitParticipant::expect(const model::Network& target) {
  tasks_.expect(target);
  return {};
}

Result<void> CommitParticipant::begin_transition(const model::Network& before, const model::Network& target) {
  tasks_.begin_transition(before, target);
  return {};
}

void CommitParticipant::begin_in_order(std::vector<model::Action> actions, Duration action_deadline,
                                       task_host::Completion completed) {
  begin_in_order(std::move(actions), action_deadline, completed,
                 [this](std::vector<model::Action> batch, TimePoint deadline, task_host::Completion ended) {
                   tasks_.begin_all(std::move(batch), deadline, std::move(ended));
                 });
}

void CommitParticipant::begin_in_order(std::vector<model::Action> actions, Duration action_deadline,
                                       const task_host::Completion& completed, Begin begin) {
  const std::size_t count = actions.size();
  task_host::OrderedActions::Performer performer{std::move(begin), [this] { return tasks_.observe(); }};
  auto ordered = std::make_shared<task_host::OrderedActions>(std::move(actions), action_deadline,
                                                             std::move(performer), completed);
  std::stop_token stop;
  {
    const Lock lock(stop_mutex_);
    stop = stop_.get_token();
  }
  if (!pool_.submit([ordered = std::move(ordered), stop] { ordered->run({stop}); })) {
    completed(
        task_host::all_failed(count, fail(ErrorCode::ResourceExhausted, "the host has no thread for it")));
  }
}

void CommitParticipant::begin_no_more() {
  std::stop_source stopped;
  {
    const Lock lock(stop_mutex_);
    std::swap(stopped, stop_);
  }
  stopped.request_stop();
}

Result<void> CommitParticipant::get_ready(const model::Network& target, const std::vector<LinkWait>& links,
                                          TimePoint deadline) {
  std::vector<Result<void>> found(links.size());
  std::atomic<std::size_t> next{0};
  const auto wait_for_some = [&] {
    for (std::size_t i = next++; i < links.size(); i = next++)
      found[i] = wait_for(links[i], deadline);
  };
  std::vector<concurrent::ThreadPool::Job> jobs{[&] { tasks_.get_ready(target); }};
  for (std::size_t waiting = 0; waiting < std::min(links.size(), kMostWaits); ++waiting) {
    jobs.emplace_back(wait_for_some);
  }
  pool_.run_all(std::move(jobs));
  const auto missed = std::find_if(found.begin(), found.end(), [](const auto& one) { return !one; });
  return missed == found.end() ? Result<void>() : std::move(*missed);
}

Result<void> CommitParticipant::wait_for(const LinkWait& link, TimePoint deadline) {
  const Duration left = std::max(Duration(0), deadline - RealClock::instance().now());
  type::ValueMap arguments;
  arguments.append("count", link.count);
  arguments.append("timeout_ms", std::chrono::duration_cast<std::chrono::milliseconds>(left).count());
  const auto found = tasks_.call(link.task, "wait_matched", std::move(arguments), deadline + kAnswering);
  if (!found) {
    return found.error();
  }
  const double matched = found->is_number() ? found->as_double() : 0;
  if (matched < link.count) {
    return fail(ErrorCode::DeadlineExceeded,
                "has found " + std::to_string(static_cast<int>(matched)) + " of " +
                    std::to_string(link.count) + " counterparts on other hosts within " +
                    format_seconds(left) +
                    "; check the addresses of the hosts, and that UDP passes between them",
                link.task.str());
  }
  return {};
}

Result<void> CommitParticipant::arm_commit(const model::Transition& transition, std::uint64_t number,
                                           TimePoint deadline) {
  if (auto armed = tasks_.arm_commit(transition, deadline); !armed) {
    return armed;
  }
  const Lock lock(mutex_);
  armed_ = number;
  promised_ = false;
  return {};
}

Result<void> CommitParticipant::vote(std::uint64_t number, Duration validity) {
  const Lock lock(mutex_);
  if (number == 0 || number != armed_) {
    return fail(ErrorCode::InvalidState, "transition " + std::to_string(number) + " is not armed here");
  }
  promised_ = true;
  until_ = clock_.now() + validity;
  return {};
}

Result<void> CommitParticipant::commit(std::uint64_t number) {
  const Lock lock(mutex_);
  if (number == 0 || number != armed_ || !promised_) {
    return fail(ErrorCode::InvalidState,
                "transition " + std::to_string(number) + " is not to be committed here");
  }
  promised_ = false;
  armed_ = 0;
  if (const Duration late = clock_.now() - until_; late > Duration(0)) {
    return fail(ErrorCode::InvalidState, "the order to commit transition " + std::to_string(number) +
                                             " came " + format_seconds(late) + " too late");
  }
  return tasks_.commit();
}

Result<void> CommitParticipant::conclude(const model::Transition& transition) {
  tasks_.conclude(transition);
  return {};
}

Result<void> CommitParticipant::withdraw() {
  {
    const Lock lock(mutex_);
    armed_ = 0;
    promised_ = false;
  }
  tasks_.withdraw();
  return {};
}

Result<void> CommitParticipant::end_processes(TimePoint deadline) {
  tasks_.end_processes(deadline);
  return {};
}

void CommitParticipant::set_listener(task_host::TaskHost::Listener listener) {
  tasks_.set_listener(std::move(listener));
}

void CommitParticipant::begin_all(std::vector<model::Action> actions, TimePoint deadline,
                                  task_host::Completion completed) {
  tasks_.begin_all(std::move(actions), deadline, std::move(completed));
}

}  // namespace segue::distributed
