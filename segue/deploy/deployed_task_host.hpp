// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/deploy/deployment_service.hpp>
#include <segue/host/task_host.hpp>
#include <segue/process/process_service.hpp>

#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace segue::deploy {

/// How the socket of a deployment process becomes its service (control/ provides it). `gone` is called once,
/// from any thread, when the connection breaks.
using Connector = std::function<Result<std::unique_ptr<DeploymentService>>(
    const std::filesystem::path& socket, TimePoint deadline, std::function<void()> gone)>;

struct DeployedOptions {
  /// How long a process may take to be looked at before it counts as one that does not answer. A computer
  /// that is merely busy must not look like one that hangs.
  Duration patience = std::chrono::seconds(2);
  /// Time between two looks that nobody asked for: they find what hangs, and take off connections' endpoints
  /// that a dead process left behind.
  Duration watch = std::chrono::seconds(1);
  /// Names of this computer; all others are computers that cannot be reached from here.
  std::vector<model::HostName> hosts = {model::kLocalHost};
};

/// One TaskHost over the tasks of the runtime's own process and those of all deployment processes of a robot
/// on this host.
///
/// What is observed: processes that answer, with their tasks, and connections both of whose endpoints are
/// connected. A process that ended by itself is not there any more, nor are its tasks and connections; a
/// process that does not answer is there with its tasks Fatal, as is a task one of whose hooks hangs, so that
/// the next transition replaces the process; should it answer again before, they are what they were. Whatever
/// happens to a process is told to the listener.
class DeployedTaskHost final : public host::TaskHost {
 public:
  /// `own` is the runtime's process. `launch` is what every process begins with, its deployment aside. All
  /// references must outlive this. Deployments of `launch.robot` that already run are adopted; of those that
  /// cannot be (another version) the listener is told, as soon as there is one.
  DeployedTaskHost(DeploymentService& own, process::ProcessService& processes, Connector connector,
                   process::Launch launch, const host::TaskHost& local, const DeployedOptions& options = {});
  /// Lets the processes run on.
  ~DeployedTaskHost() override;

  /// Side by side in their processes: one message for each process and kind of work, three for connections
  /// between processes however many they are.
  void perform_all(std::span<const model::Action> actions, TimePoint deadline,
                   const host::Completion& completed) override;
  using TaskHost::perform_all;

  [[nodiscard]] model::Depth validation_depth() const override;
  Result<void> can_make(const model::ComponentName& component) const override;
  /// Refuses tasks on other computers, and connections between processes that insist on another link than
  /// shared memory.
  [[nodiscard]] Diagnostics check(const model::Network& network) const override;
  void expect(const model::Network& target) override;
  /// Processes that its connections will join map each other's memory.
  void get_ready(const model::Network& target) override;
  [[nodiscard]] bool side_by_side() const override { return true; }
  void conclude(const model::Transition& transition) override;
  void withdraw() override;
  Result<void> perform(const model::Action& action, TimePoint deadline) override;
  [[nodiscard]] model::Network observe() const override;
  [[nodiscard]] std::vector<host::TaskReport> tasks() const override;
  [[nodiscard]] std::vector<host::ConnectionReport> connections() const override;
  Result<model::ComponentModel> describe(const model::TaskId& task) const override;
  Result<type::Value> properties(const model::TaskId& task) const override;
  Result<void> set_property(const model::TaskId& task, std::string_view path, const type::Value& value,
                            TimePoint deadline) override;
  Result<type::Value> call(const model::TaskId& task, std::string_view operation,
                           const type::Value& arguments, TimePoint deadline) override;
  Result<std::unique_ptr<host::PortReader>> open_reader(const model::PortRef& port,
                                                        std::size_t buffer) override;
  void set_listener(Listener listener) override;

  /// Ends all processes but the runtime's own, whatever they hold and whether they answer: for a robot that
  /// cannot be brought to the empty network. Blocks until they are gone, until `deadline` at most.
  void end_processes(TimePoint deadline);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::deploy
