// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/deploy/deployment_service.hpp>
#include <segue/host/task_host.hpp>
#include <segue/model/network.hpp>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace segue::deploy::detail {

/// One process as it was last seen.
struct ProcessView {
  model::Deployment deployment;  ///< as it was started, without tasks; the runtime's own has no name
  int pid = 0;
  link::Incarnation incarnation = 0;         ///< 0: it never told
  std::shared_ptr<const Snapshot> snapshot;  ///< the last one; may be null where it does not answer
  bool answers = true;
};

/// An endpoint whose counterpart is missing.
struct OrphanedEndpoint {
  model::DeploymentKey process;
  model::Connection connection;
  Side side = Side::Output;
  link::Incarnation peer = 0;
  bool peer_gone = false;  ///< no process that runs has the peer's incarnation
};

/// Several processes as one.
struct MergedView {
  model::Network network;
  std::vector<host::TaskReport> tasks;
  std::vector<host::ConnectionReport> connections;
  std::vector<OrphanedEndpoint> orphaned;
};

/// How a process's task is called outside: where two processes have a task, only one has the plain id.
using FindName = std::function<model::TaskId(const model::TaskId& task, const model::DeploymentKey& process)>;

/// What the processes show together, tasks called as `name_of` says.
///
/// A process that does not answer is there with the tasks that it had, Fatal, and without connections; since
/// nobody knows what became of it, its deployment counts as one of another kind (its deployer is "unknown"),
/// so that whoever wants it starts it anew.
MergedView merge(const std::vector<ProcessView>& processes, const FindName& name_of);

/// Why tasks of a process that does not answer are Fatal.
std::string silence_text(const model::DeploymentKey& process, int pid);
/// Why a task is Fatal one of whose hooks hangs.
std::string hanging_text(const model::DeploymentKey& process);

}  // namespace segue::deploy::detail
