// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/deploy/deployment_service.hpp>
#include <segue/model/network.hpp>
#include <segue/task_host/task_host.hpp>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace segue::fleet::detail {

/// One process as it was polled last.
struct ProcessView {
  model::Deployment deployment;  ///< as it was started, without tasks; the runtime's own has no name
  int pid = 0;
  sample_link::Incarnation incarnation = 0;  ///< 0: not known yet
  std::shared_ptr<const deploy::Snapshot>
      snapshot;  ///< the latest one; may be null where the process does not answer
  bool answers = true;
  std::string fault{};  ///< why a transition replaces it although it answers; "" where none does
  /// Whether the process does not answer. Never true of the runtime's own process, which is only busy then:
  /// its last answer counts.
  [[nodiscard]] bool is_silent() const { return !answers && !deployment.key().is_runtime(); }
  [[nodiscard]] bool is_to_be_replaced() const { return is_silent() || !fault.empty(); }
};

/// An endpoint whose counterpart in the other process is missing, or that carries nothing: before the
/// commit of a transition, or after the one with which it ended.
struct OrphanedEndpoint {
  model::DeploymentKey process;
  model::Connection connection;
  deploy::Side side = deploy::Side::Output;
  sample_link::Incarnation peer = 0;
  bool peer_gone = false;  ///< the other process has ended
};

/// A process that can have written to some shared memory.
struct Suspect {
  model::DeploymentKey process;
  sample_link::Incarnation incarnation = 0;
  friend bool operator==(const Suspect&, const Suspect&) = default;
};

/// A connection whose memory was overwritten. Its endpoints are among the orphaned ones, and it is not part
/// of the network.
struct DamagedConnection {
  model::Connection connection;
  std::uint64_t corrupt = 0;  ///< invalid entries that both endpoints have found
  /// The processes that can have overwritten it: the writer's where a sample itself is invalid; else the
  /// reader's, whose memory it is, and all with connections to that.
  std::vector<Suspect> suspects;
};

/// The tasks and connections of all processes together.
struct MergedView {
  model::Network network;
  std::vector<task_host::TaskReport> tasks;
  std::vector<task_host::ConnectionReport> connections;
  std::vector<OrphanedEndpoint> orphaned;
  std::vector<DamagedConnection> damaged;
};

/// Names a task of a process towards callers: where two processes hold a task, only one of them has the plain
/// id.
using FindName = std::function<model::TaskId(const model::TaskId& task, const model::DeploymentKey& process)>;

/// Merges the processes into one view; tasks are named by `name_of`.
///
/// A task that hangs is Fatal in its process's snapshot already; here, its error gets what helps. A process
/// that does not answer keeps its last known tasks, in state Fatal, and loses its connections. Tasks of one
/// with a fault are Fatal, too. The deployer of both becomes "unknown", which makes it differ from every
/// wanted deployment, so that a transition replaces it.
MergedView merge(const std::vector<ProcessView>& processes, const FindName& name_of);

/// "process 'a'", "one of the processes 'a' and 'b'".
std::string suspect_text(const std::vector<Suspect>& suspects);
/// Why a connection is missing.
std::string damage_text(const DamagedConnection& damaged);
/// Why tasks of a process that does not answer are Fatal.
std::string silence_text(const model::DeploymentKey& process, int pid);
/// Why a task that hangs is Fatal: what the process reports about it, and what helps.
std::string hanging_text(const ProcessView& process, const model::TaskId& task);

}  // namespace segue::fleet::detail
