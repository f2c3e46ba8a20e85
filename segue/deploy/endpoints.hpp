// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/deploy/endpoint_table.hpp>
#include <segue/sample_link/shared_memory.hpp>
#include <segue/task_host/local_task_host.hpp>

#include <memory>
#include <span>
#include <vector>

namespace segue::deploy::detail {

/// Creates and closes this process's endpoints of connections to other processes, at the ports of its tasks.
/// Thread safe; the deadlines bound the wait for hooks that create or remove ports.
class Endpoints {
 public:
  /// `memory` may be null: connections to other processes are refused then. `host` must outlive this.
  Endpoints(task_host::LocalTaskHost& host, std::shared_ptr<sample_link::SharedMemory> memory)
      : host_(host), memory_(std::move(memory)) {}

  /// Offers the memory of this process to others, and admits theirs; see DeploymentService.
  [[nodiscard]] Result<sample_link::MemoryOffer> offer() const;
  Result<void> admit(const sample_link::MemoryOffer& peer);
  Result<void> forget(sample_link::Incarnation peer);

  /// The three steps of a connection; see DeploymentService.
  Result<sample_link::OutputOrigin> describe(const model::PortRef& port, TimePoint deadline);
  Result<sample_link::InputPlace> open(const OpenInput& input, TimePoint deadline);
  Result<void> attach(const AttachOutput& output, TimePoint deadline);
  /// Closes an endpoint, once the reader has taken what the connection owes it. Has no effect where there is
  /// none.
  Result<void> close(const CloseEndpoint& what, TimePoint deadline);
  void close_all();

  /// end_at(): these endpoints end when the gate opens. settle(): the transition of the gates has ended.
  void end_at(const task::CommitGatePtr& gate, std::span<const ArmCommit::Endpoint> ending);
  void settle();

  [[nodiscard]] std::vector<EndpointReport> reports();
  [[nodiscard]] sample_link::MemoryUsage usage() const;

 private:
  void release(const Endpoint& endpoint);

  task_host::LocalTaskHost& host_;
  const std::shared_ptr<sample_link::SharedMemory> memory_;
  EndpointTable table_;
};

}  // namespace segue::deploy::detail
