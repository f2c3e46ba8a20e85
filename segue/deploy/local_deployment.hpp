// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/deploy/deployment_service.hpp>
#include <segue/sample_link/shared_memory.hpp>
#include <segue/task_host/local_task_host.hpp>
#include <segue/task_host/task_access.hpp>
#include <segue/task_host/task_forwarder.hpp>

#include <memory>

namespace segue::deploy {

/// The tasks of this process as a deployment: those of a deployment process, or the runtime's own.
class LocalDeployment final : public task_host::TaskForwarder<DeploymentService> {
 public:
  /// `host` must outlive this, and holds only tasks of `info.deployment` (whose empty process name stands for
  /// the runtime's own). `memory` may be null: no connections to other processes then.
  LocalDeployment(DeploymentInfo info, task_host::LocalTaskHost& host,
                  std::shared_ptr<sample_link::SharedMemory> memory);
  ~LocalDeployment() override;

  /// Stops and cleans up all tasks, producers first, and closes all endpoints; actions answer Unavailable
  /// from now on. False where a hook has not returned by `deadline`. Its thread still runs, so neither this
  /// nor the host may be destroyed then: end the process by std::_Exit.
  bool shut_down(TimePoint deadline);

  Result<DeploymentInfo> info() override;
  Result<Snapshot> snapshot() override;
  Result<void> expect(const model::Network& network) override;
  void begin_all(std::vector<model::Action> actions, TimePoint deadline,
                 task_host::Completion completed) override;
  Result<void> arm_commit(const ArmCommit& what, TimePoint deadline) override;
  Result<void> settle(TimePoint deadline) override;
  Result<void> conclude(const model::Transition& transition, TimePoint deadline) override;
  Result<std::optional<task::SavedState>> save_state(const model::TaskId& task, TimePoint deadline) override;
  Result<void> restore_state(const model::TaskId& task, const task::SavedState& state,
                             TimePoint deadline) override;
  Result<sample_link::MemoryOffer> memory(TimePoint deadline) override;
  Result<void> admit(const sample_link::MemoryOffer& peer, TimePoint deadline) override;
  Result<void> forget(sample_link::Incarnation peer) override;
  std::vector<Result<sample_link::OutputOrigin>> describe_outputs(std::span<const model::PortRef> ports,
                                                                  TimePoint deadline) override;
  std::vector<Result<sample_link::InputPlace>> open_inputs(std::span<const OpenInput> inputs,
                                                           TimePoint deadline) override;
  std::vector<Result<void>> attach_outputs(std::span<const AttachOutput> outputs,
                                           TimePoint deadline) override;
  std::vector<Result<void>> close_endpoints(std::span<const CloseEndpoint> endpoints,
                                            TimePoint deadline) override;
  void set_listener(Listener listener) override;

 protected:
  [[nodiscard]] Result<task_host::TaskPlace> find_place(const model::TaskId& task,
                                                        task_host::Purpose purpose) const override;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::deploy
