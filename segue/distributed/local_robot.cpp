// SPDX-License-Identifier: Apache-2.0
#include <segue/distributed/local_robot.hpp>

#include <unistd.h>

#include <functional>
#include <utility>

namespace segue::distributed::detail {

namespace {

deploy::DeploymentInfo daemon_info(const process_server::Launch& launch) {
  deploy::DeploymentInfo info;
  info.robot = launch.robot;
  info.pid = ::getpid();
  info.software = SEGUE_VERSION;
  return info;
}

/// The data of a batch, kept until all of its actions are reported.
struct BatchWork {
  BatchWork(Lease::Work begun, std::shared_ptr<LocalRobot> robot, std::size_t count,
            task_host::Completion report)
      : work(std::move(begun)), here(std::move(robot)), left(count), completed(std::move(report)) {}

  const Lease::Work work;
  const std::shared_ptr<LocalRobot> here;
  std::atomic<std::size_t> left;  ///< actions to be reported; the report that brings it to 0 ends the work
  const task_host::Completion completed;
};

/// One runtime's hold on a robot.
class Session final : public task_host::TaskForwarder<HostedRobot> {
 public:
  Session(std::shared_ptr<LeasedRobot> robot, std::uint64_t epoch)
      : robot_(std::move(robot)), epoch_(epoch) {}

  Result<void> renew() override { return robot_->lease.renew(epoch_); }
  Result<void> release() override { return robot_->lease.release(epoch_); }
  Result<HostView> snapshot() override {
    return work([](CommitParticipant& part) { return part.snapshot(); });
  }
  Result<void> expect(const model::Network& target) override {
    return work([&](CommitParticipant& part) { return part.expect(target); });
  }
  Result<void> begin_transition(const model::Network& before, const model::Network& target) override {
    return work([&](CommitParticipant& part) { return part.begin_transition(before, target); });
  }
  void begin_in_order(std::vector<model::Action> actions, Duration action_deadline,
                      task_host::Completion completed) override;
  void begin_no_more() override {
    const Lease::Work working(robot_->lease, epoch_);
    if (working) {
      robot_->here->part().begin_no_more();
    }
  }
  Result<void> get_ready(const model::Network& target, const std::vector<LinkWait>& links,
                         TimePoint deadline) override {
    return work([&](CommitParticipant& part) { return part.get_ready(target, links, deadline); });
  }
  Result<void> arm_commit(const model::Transition& transition, std::uint64_t number,
                          TimePoint deadline) override {
    return work([&](CommitParticipant& part) { return part.arm_commit(transition, number, deadline); });
  }
  Result<void> vote(std::uint64_t number, Duration validity) override {
    return work([&](CommitParticipant& part) { return part.vote(number, validity); });
  }
  Result<void> commit(std::uint64_t number) override {
    return work([&](CommitParticipant& part) { return part.commit(number); });
  }
  Result<void> conclude(const model::Transition& transition) override {
    return work([&](CommitParticipant& part) { return part.conclude(transition); });
  }
  Result<void> withdraw() override {
    return work([](CommitParticipant& part) { return part.withdraw(); });
  }
  Result<void> end_processes(TimePoint deadline) override {
    return work([&](CommitParticipant& part) { return part.end_processes(deadline); });
  }
  void set_listener(task_host::TaskHost::Listener listener) override {
    const Lease::Work working(robot_->lease, epoch_);
    if (working) {
      robot_->here->part().set_listener(std::move(listener));
    }
  }

  void begin_all(std::vector<model::Action> actions, TimePoint deadline,
                 task_host::Completion completed) override;

 protected:
  /// The call is work under the lease.
  [[nodiscard]] Result<task_host::TaskPlace> find_place(const model::TaskId& task,
                                                        task_host::Purpose /*purpose*/) const override {
    const auto working = std::make_shared<Lease::Work>(robot_->lease, epoch_);
    if (!*working) {
      return robot_->lease.refusal(epoch_);
    }
    return task_host::TaskPlace{{working, &robot_->here->part()}, task};
  }

 private:
  template <class Do>
  auto work(Do what) -> decltype(what(std::declval<CommitParticipant&>())) {
    const Lease::Work working(robot_->lease, epoch_);
    if (!working) {
      return robot_->lease.refusal(epoch_);
    }
    return what(robot_->here->part());
  }

  const std::shared_ptr<LeasedRobot> robot_;
  const std::uint64_t epoch_;
};

/// Has `begin` carry out a batch of `count` actions as work under `epoch`.
using BeginBatch = std::function<void(CommitParticipant&, task_host::Completion)>;
void begin_as_work(LeasedRobot& robot, std::uint64_t epoch, std::size_t count,
                   task_host::Completion completed, const BeginBatch& begin) {
  Lease::Work working(robot.lease, epoch);
  if (!working) {
    return completed(task_host::all_failed(count, robot.lease.refusal(epoch)));
  }
  if (count == 0) {
    return;
  }
  auto batch = std::make_shared<BatchWork>(std::move(working), robot.here, count, std::move(completed));
  auto& part = batch->here->part();
  begin(part, [batch = std::move(batch)](std::vector<task_host::Completed> ended) mutable {
    const std::size_t reported = ended.size();
    batch->completed(std::move(ended));
    if (batch->left.fetch_sub(reported) == reported) {
      batch.reset();  // no longer work, though the host may keep this function
    }
  });
}

void begin_batch(LeasedRobot& robot, std::uint64_t epoch, std::vector<model::Action> actions,
                 TimePoint deadline, task_host::Completion completed) {
  const std::size_t count = actions.size();
  begin_as_work(robot, epoch, count, std::move(completed),
                [&](CommitParticipant& part, task_host::Completion report) {
                  part.begin_all(std::move(actions), deadline, std::move(report));
                });
}

void Session::begin_all(std::vector<model::Action> actions, TimePoint deadline,
                        task_host::Completion completed) {
  begin_batch(*robot_, epoch_, std::move(actions), deadline, std::move(completed));
}

void Session::begin_in_order(std::vector<model::Action> actions, Duration action_deadline,
                             task_host::Completion completed) {
  const std::size_t count = actions.size();
  // The robot may be given to another runtime while the actions are carried out: each is work of its own,
  // too.
  const auto begin = [robot = robot_, epoch = epoch_](std::vector<model::Action> ready, TimePoint deadline,
                                                      task_host::Completion report) {
    begin_batch(*robot, epoch, std::move(ready), deadline, std::move(report));
  };
  begin_as_work(*robot_, epoch_, count, std::move(completed),
                [&](CommitParticipant& part, const task_host::Completion& report) {
                  part.begin_in_order(std::move(actions), action_deadline, report, begin);
                });
}

}  // namespace

LocalRobot::LocalRobot(process_server::Launch launch,
                       std::unique_ptr<process_server::ProcessService> processes, fleet::Connector connector,
                       const model::HostName& host, const Clock& clock)
    : launch_(std::move(launch)),
      processes_(std::move(processes)),
      own_(daemon_info(launch_), no_tasks_, nullptr),
      tasks_(own_, *processes_, std::move(connector), launch_, no_tasks_, {.hosts = {host}}),
      part_(tasks_, clock) {}

std::shared_ptr<HostedRobot> make_session(std::shared_ptr<LeasedRobot> robot, std::uint64_t epoch) {
  return std::make_shared<Session>(std::move(robot), epoch);
}

}  // namespace segue::distributed::detail
