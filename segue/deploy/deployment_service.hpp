// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/host/task_host.hpp>
#include <segue/link/shared_connection.hpp>
#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// Deployments: processes that hold tasks. Starts and watches them, what runs inside, and one TaskHost over
/// all.
namespace segue::deploy {

/// Who a deployment process is.
struct DeploymentInfo {
  std::string robot;
  model::Deployment deployment;  ///< as it was started; its list of tasks is empty
  int pid = 0;
  std::string software;  ///< version of Segue
  link::Incarnation incarnation = 0;
};

enum class Side : std::uint8_t { Output, Input };

/// One endpoint of a connection between processes, as its process sees it.
struct EndpointReport {
  model::Connection connection;
  Side side = Side::Output;
  link::Incarnation peer = 0;
  link::InputPlace place;  ///< what identifies it: both endpoints of a connection name the same one
  link::Counters counters;
};

/// All that a process holds, at one moment.
struct Snapshot {
  model::Network network;  ///< its tasks with true states, its placements, connections inside
  std::vector<host::TaskReport> tasks;
  std::vector<host::ConnectionReport> connections;  ///< inside
  std::vector<EndpointReport> endpoints;
  link::MemoryUsage memory;
  /// Tasks one of whose hooks has not returned although the deadline of its action has passed.
  std::vector<model::TaskId> hanging;
};

/// A connection of which the other end lives in another process.
struct OpenInput {
  model::Connection connection;
  link::OutputOrigin origin;
};
struct AttachOutput {
  model::Connection connection;
  link::InputPlace place;
};
struct CloseEndpoint {
  model::Connection connection;
  Side side = Side::Output;
  bool peer_closed =
      false;  ///< Input: the writer's endpoint is gone or never was, so its ring's place is free
  link::Incarnation peer = 0;  ///< the process at the other end: a connection may lead to two incarnations
};

/// What a process with tasks offers, in the same process or (control/) in another. Functions may be called
/// from any thread and block until their deadline at most; those without one answer within moments, or
/// Unavailable where the process is gone and DeadlineExceeded where it does not answer. Lists of outcomes
/// have one entry for each thing asked.
class DeploymentService {
 public:
  virtual ~DeploymentService() = default;

  virtual Result<DeploymentInfo> info() = 0;
  virtual Result<Snapshot> snapshot() = 0;

  /// Stand-ins made from now on have the ports that `network` names (the part that concerns this process).
  virtual Result<void> expect(const model::Network& network) = 0;
  /// Begins to carry out actions on tasks and connections of this process that do not depend on each other,
  /// side by side, and returns without waiting for hooks. `completed` is told each of them once, by
  /// `deadline` and a little at the latest, as TaskHost::perform_all says; from any thread, also before this
  /// returns, and it must not call back into this. This must not be destroyed before all are told.
  virtual void begin_all(std::vector<model::Action> actions, TimePoint deadline,
                         host::Completion completed) = 0;
  /// The same, and waits; outcomes in the order of `actions`.
  std::vector<Result<void>> perform(std::span<const model::Action> actions, TimePoint deadline);
  /// Forgets and redefines tasks as TaskHost::conclude does.
  virtual Result<void> conclude(const model::Transition& transition, TimePoint deadline) = 0;

  /// For a task that takes over from one in another process: what a Stopped task remembers (nothing, where
  /// its component has no state), and a task that is configured and does not run continues it.
  virtual Result<std::optional<task::SavedState>> save_state(const model::TaskId& task,
                                                             TimePoint deadline) = 0;
  virtual Result<void> restore_state(const model::TaskId& task, const task::SavedState& state,
                                     TimePoint deadline) = 0;

  virtual Result<model::ComponentModel> describe(const model::TaskId& task) = 0;
  virtual Result<type::Value> properties(const model::TaskId& task) = 0;
  virtual Result<void> set_property(const model::TaskId& task, std::string_view path,
                                    const type::Value& value, TimePoint deadline) = 0;
  virtual Result<type::Value> call(const model::TaskId& task, std::string_view operation,
                                   const type::Value& arguments, TimePoint deadline) = 0;
  virtual Result<std::unique_ptr<host::PortReader>> open_reader(const model::PortRef& port,
                                                                std::size_t buffer) = 0;

  /// For connections between processes: first offers are exchanged, then describe, open, attach; endpoints
  /// are closed the other way round.
  virtual Result<link::MemoryOffer> memory(TimePoint deadline) = 0;
  virtual Result<void> admit(const link::MemoryOffer& peer, TimePoint deadline) = 0;
  virtual Result<void> forget(link::Incarnation peer) = 0;
  virtual std::vector<Result<link::OutputOrigin>> describe_outputs(std::span<const model::PortRef> ports,
                                                                   TimePoint deadline) = 0;
  virtual std::vector<Result<link::InputPlace>> open_inputs(std::span<const OpenInput> inputs,
                                                            TimePoint deadline) = 0;
  virtual std::vector<Result<void>> attach_outputs(std::span<const AttachOutput> outputs,
                                                   TimePoint deadline) = 0;
  virtual std::vector<Result<void>> close_endpoints(std::span<const CloseEndpoint> endpoints,
                                                    TimePoint deadline) = 0;

  /// What happens to tasks by themselves. Called from any thread; must not block nor call back into this. No
  /// call is under way any more when set_listener returns.
  using Listener = std::function<void(const host::TaskEvent&)>;
  virtual void set_listener(Listener listener) = 0;
};

}  // namespace segue::deploy
