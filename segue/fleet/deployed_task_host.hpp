// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/deploy/deployment_service.hpp>
#include <segue/process_server/process_service.hpp>
#include <segue/task_host/task_access.hpp>
#include <segue/task_host/task_forwarder.hpp>
#include <segue/task_host/task_host.hpp>

#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace segue::fleet {

/// Connects to a deployment process by its socket (control/ provides this). `gone` is called once, from any
/// thread, when the connection breaks.
using Connector = std::function<Result<deploy::ConnectedDeployment>(
    const std::filesystem::path& socket, TimePoint deadline, std::function<void()> gone)>;

struct DeployedOptions {
  /// How long a process may take to answer a poll before it counts as one that does not answer. Long enough
  /// that a computer that is merely busy does not look like one that hangs.
  Duration patience = std::chrono::seconds(2);
  /// Period of the polls that nobody requested. They find processes and hooks that hang, and endpoints that a
  /// dead process left behind.
  Duration watch = std::chrono::seconds(1);
  /// Names of this computer. Processes on all other hosts are refused.
  std::vector<model::HostName> hosts = {model::kLocalHost};
};

/// One TaskHost over the tasks of the runtime's own process and those of all deployment processes of a robot
/// on this host.
///
/// observe() shows the processes that answer with their tasks, and the connections both of whose endpoints
/// are connected. A process that ended by itself is missing, with its tasks and connections. The tasks of a
/// process that does not answer are Fatal, as is a task with a hook that hangs, so that the next transition
/// replaces the process; if it answers again before that, they have their former states. The runtime's own
/// process, which nothing can replace, is only busy then, and is shown as it was last. The listener gets an
/// event of each such change.
class DeployedTaskHost final : public task_host::TaskForwarder<task_host::TaskHost> {
 public:
  /// `own` is the runtime's process, `launch` the template for starting others. All references must outlive
  /// this. Running deployments of `launch.robot` are adopted; the listener, as soon as there is one, gets an
  /// event of each and of those that cannot be adopted (another version of Segue).
  DeployedTaskHost(deploy::DeploymentService& own, process_server::ProcessService& processes,
                   Connector connector, process_server::Launch launch, const task_host::TaskHost& local,
                   const DeployedOptions& options = {});
  /// Stops watching; the processes run on.
  ~DeployedTaskHost() override;

  /// One message for each process and kind of work, all processes at the same time; three for connections
  /// between processes however many they are.
  void begin_all(std::vector<model::Action> actions, TimePoint deadline,
                 task_host::Completion completed) override;

  [[nodiscard]] bool stands_in(const model::ComponentName& component) const override;
  Result<void> can_make(const model::ComponentName& component) const override;
  /// Refuses processes on other computers, and connections between processes with another link than shared
  /// memory.
  [[nodiscard]] Diagnostics check(const model::Network& network) const override;
  void expect(const model::Network& target) override;
  /// Makes processes that `target` connects map each other's memory.
  void begin_transition(const model::Network& before, const model::Network& target) override;
  void get_ready(const model::Network& target) override;
  Result<void> arm_commit(const model::Transition& transition, TimePoint deadline) override;
  Result<void> commit() override;
  [[nodiscard]] bool side_by_side() const override { return true; }
  void conclude(const model::Transition& transition) override;
  void withdraw() override;
  [[nodiscard]] model::Network observe() const override;
  [[nodiscard]] std::vector<task_host::TaskReport> tasks() const override;
  [[nodiscard]] std::vector<task_host::ConnectionReport> connections() const override;
  void set_listener(Listener listener) override;

  /// observe(), tasks() and connections() of one moment.
  [[nodiscard]] View snapshot() const override;
  /// Ends all processes but the runtime's own, whether or not they answer and whatever tasks they hold; for a
  /// robot that no transition brings to the empty network. Blocks until they have ended, until `deadline` at
  /// most.
  void end_processes(TimePoint deadline);

 protected:
  [[nodiscard]] Result<task_host::TaskPlace> find_place(const model::TaskId& task,
                                                        task_host::Purpose purpose) const override;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::fleet
