// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/mutex.hpp>
#include <segue/concurrent/thread_pool.hpp>
#include <segue/distributed/hosted_robot.hpp>
#include <segue/fleet/deployed_task_host.hpp>
#include <segue/task_host/task_access.hpp>
#include <segue/task_host/task_forwarder.hpp>

#include <functional>
#include <memory>
#include <stop_token>
#include <vector>

namespace segue::distributed {

/// The deployments of a robot on this computer as a HostedRobot without a lease: its owner commands them.
class CommitParticipant final : public task_host::TaskForwarder<HostedRobot> {
 public:
  /// `tasks` must outlive this. `clock` is what promises to commit are measured with.
  explicit CommitParticipant(fleet::DeployedTaskHost& tasks, const Clock& clock = RealClock::instance())
      : tasks_(tasks), clock_(clock) {}

  Result<void> renew() override { return {}; }
  Result<void> release() override { return {}; }
  Result<HostView> snapshot() override;
  Result<void> expect(const model::Network& target) override;
  Result<void> begin_transition(const model::Network& before, const model::Network& target) override;
  void begin_in_order(std::vector<model::Action> actions, Duration action_deadline,
                      task_host::Completion completed) override;
  void begin_no_more() override;
  Result<void> get_ready(const model::Network& target, const std::vector<LinkWait>& links,
                         TimePoint deadline) override;
  Result<void> arm_commit(const model::Transition& transition, std::uint64_t number,
                          TimePoint deadline) override;
  Result<void> vote(std::uint64_t number, Duration validity) override;
  Result<void> commit(std::uint64_t number) override;
  Result<void> conclude(const model::Transition& transition) override;
  Result<void> withdraw() override;
  Result<void> end_processes(TimePoint deadline) override;
  void set_listener(task_host::TaskHost::Listener listener) override;

  /// begin_in_order() where each action that is ready is begun by `begin`.
  using Begin = std::function<void(std::vector<model::Action>, TimePoint, task_host::Completion)>;
  void begin_in_order(std::vector<model::Action> actions, Duration action_deadline,
                      const task_host::Completion& completed, Begin begin);

  void begin_all(std::vector<model::Action> actions, TimePoint deadline,
                 task_host::Completion completed) override;

 protected:
  [[nodiscard]] Result<task_host::TaskPlace> find_place(const model::TaskId& task,
                                                        task_host::Purpose /*purpose*/) const override {
    return task_host::place_at(tasks_, task);
  }

 private:
  fleet::DeployedTaskHost& tasks_;
  const Clock& clock_;
  Result<void> wait_for(const LinkWait& link, TimePoint deadline);

  Mutex stop_mutex_;  ///< protects the member below
  /// Stops the actions that begin_in_order() was given since the last begin_no_more().
  std::stop_source stop_ SEGUE_GUARDED_BY(stop_mutex_);
  Mutex mutex_;  ///< protects the members below; held while a transition commits
  std::uint64_t armed_ SEGUE_GUARDED_BY(mutex_) = 0;  ///< the transition that can commit; 0: none
  bool promised_ SEGUE_GUARDED_BY(mutex_) = false;    ///< commit() is obeyed until `until_`
  TimePoint until_ SEGUE_GUARDED_BY(mutex_){};
  concurrent::ThreadPool pool_{"segue-ordered", {64, 1}};
};

}  // namespace segue::distributed
