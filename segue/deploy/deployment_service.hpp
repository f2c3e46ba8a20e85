// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>
#include <segue/sample_link/commit_page.hpp>
#include <segue/sample_link/shared_connection.hpp>
#include <segue/task_host/task_access.hpp>
#include <segue/task_host/task_host.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// Deployments: processes that hold tasks, their interface, and one TaskHost over all of them.
namespace segue::deploy {

/// The identity of a deployment process.
struct DeploymentInfo {
  std::string robot;
  model::Deployment deployment;  ///< as it was started, without tasks
  int pid = 0;
  std::string software;  ///< version of Segue
  sample_link::Incarnation incarnation = 0;
};

enum class Side : std::uint8_t { Output, Input };

/// One endpoint of a connection between processes, as reported by its process.
struct EndpointReport {
  model::Connection connection;
  Side side = Side::Output;
  sample_link::Incarnation peer = 0;
  sample_link::InputPlace place;  ///< identifies the connection: both of its endpoints name the same place
  sample_link::Counters counters;
  std::uint64_t corrupt = 0;  ///< invalid entries and claims of the peer; see SharedEndpoint
  sample_link::Damage damage =
      sample_link::Damage::None;   ///< other than None: the connection must be made again
  bool carries = true;             ///< false: it waits for the commit of a transition, or has ended with one
  sample_link::Latency latency{};  ///< known by the input only
};

/// Everything that a process holds at one moment.
struct Snapshot {
  model::Network network;  ///< its tasks with their actual states, placements, connections within the process
  std::vector<task_host::TaskReport> tasks;
  std::vector<task_host::ConnectionReport> connections;  ///< within the process
  std::vector<EndpointReport> endpoints;
  sample_link::MemoryUsage memory;
  /// Tasks with a hook, an update or an operation that has not returned by its deadline. They are Fatal in
  /// `network` and in `tasks`, which says what hangs.
  std::vector<model::TaskId> hanging;
};

/// Requests about one endpoint; the other endpoint belongs to another process. `at_commit`: the connection
/// begins with the commit of the transition in progress.
struct OpenInput {
  model::Connection connection;
  sample_link::OutputOrigin origin;
  bool at_commit = false;
};
struct AttachOutput {
  model::Connection connection;
  sample_link::InputPlace place;
  bool at_commit = false;
};
struct CloseEndpoint {
  model::Connection connection;
  Side side = Side::Output;
  /// Input: the writer has no endpoint (any more), so the memory of the ring may be used again.
  bool peer_closed = false;
  /// The other process, since a connection may lead to two incarnations of a task.
  sample_link::Incarnation peer = 0;
};

/// The connections of a process that end when a transition commits. Those that begin then are all connections
/// that actions before the commit make.
struct ArmCommit {
  std::shared_ptr<const sample_link::CommitPage> page;  ///< of the runtime
  std::uint64_t number = 0;                             ///< of the transition, on that page
  std::vector<model::Connection> within;                ///< connections of this process
  struct Endpoint {
    model::Connection connection;
    Side side = Side::Output;
    sample_link::Incarnation peer = 0;
  };
  std::vector<Endpoint> endpoints;  ///< of connections to other processes
};

/// The interface of a process that holds tasks: LocalDeployment in the process itself, a client (control/)
/// elsewhere. Threads and deadlines as for task_host::TaskAccess; lists of outcomes have one entry for each
/// request, in the order of the requests.
class DeploymentService : public task_host::TaskAccess {
 public:
  virtual Result<DeploymentInfo> info() = 0;
  virtual Result<Snapshot> snapshot() = 0;

  /// Stand-ins that are created from now on get the ports that `network` (the part for this process) names.
  virtual Result<void> expect(const model::Network& network) = 0;
  /// Lets connections begin and end with the store that commits a transition; before its first action of
  /// Commit.
  virtual Result<void> arm_commit(const ArmCommit& what, TimePoint deadline) = 0;
  /// The transition that connections wait for has committed or was given up, as its page says. Connections
  /// within this process that would have begun are removed; endpoints of others stay dormant, to be closed.
  virtual Result<void> settle(TimePoint deadline) = 0;
  /// Removes and redefines tasks as TaskHost::conclude() does.
  virtual Result<void> conclude(const model::Transition& transition, TimePoint deadline) = 0;

  /// Connections between processes. To connect: exchange memory() and admit() between both processes once,
  /// then describe_outputs() and open_inputs(), then attach_outputs(). To disconnect: close the output, then
  /// the input. forget() ends all connections with a process that has ended.
  virtual Result<sample_link::MemoryOffer> memory(TimePoint deadline) = 0;
  virtual Result<void> admit(const sample_link::MemoryOffer& peer, TimePoint deadline) = 0;
  virtual Result<void> forget(sample_link::Incarnation peer) = 0;
  virtual std::vector<Result<sample_link::OutputOrigin>> describe_outputs(
      std::span<const model::PortRef> ports, TimePoint deadline) = 0;
  virtual std::vector<Result<sample_link::InputPlace>> open_inputs(std::span<const OpenInput> inputs,
                                                                   TimePoint deadline) = 0;
  virtual std::vector<Result<void>> attach_outputs(std::span<const AttachOutput> outputs,
                                                   TimePoint deadline) = 0;
  virtual std::vector<Result<void>> close_endpoints(std::span<const CloseEndpoint> endpoints,
                                                    TimePoint deadline) = 0;

  /// Called from any thread when a task changes its state by itself; must neither block nor call back into
  /// this. The former listener is not being called any more when set_listener() returns.
  using Listener = std::function<void(const task_host::TaskEvent&)>;
  virtual void set_listener(Listener listener) = 0;
};

/// A deployment process with a connection, and its description of itself when it was connected.
struct ConnectedDeployment {
  std::unique_ptr<DeploymentService> service;  ///< never null
  DeploymentInfo info;
};

}  // namespace segue::deploy
