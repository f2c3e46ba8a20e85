// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/sample_link/port_connection.hpp>
#include <segue/task_host/component_library.hpp>
#include <segue/task_host/stand_in.hpp>
#include <segue/task_host/task_host.hpp>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace segue::task_host {

struct LocalOptions {
  /// Create a stand-in for every component that no loaded library provides.
  bool stand_in = false;
  /// Stand-ins for all components, even installed ones.
  bool only_stand_ins = false;
  /// How they behave; see stand_in.hpp.
  StandInTable stand_ins{};
  /// Components that are real all the same.
  std::vector<model::ComponentName> never_stand_ins{};
};

/// The tasks of this process. Deployments are only names here: the tasks of all of them live in this process
/// ("--in-process").
class LocalTaskHost final : public TaskHost {
 public:
  /// `libraries` creates components; `catalog` has the interfaces of those that stand-ins replace. Both must
  /// outlive this.
  LocalTaskHost(const LibrarySet& libraries, const model::ComponentCatalog& catalog,
                LocalOptions options = {});
  /// Waits for hooks that have not returned.
  ~LocalTaskHost() override;

  [[nodiscard]] bool stands_in(const model::ComponentName& component) const override;
  /// How stand-ins are to behave.
  [[nodiscard]] Diagnostics check(const model::Network& network) const override;
  Result<void> can_make(const model::ComponentName& component) const override;
  /// A stand-in without a model gets the ports that connections of expected networks name.
  void expect(const model::Network& target) override;
  Result<void> arm_commit(const model::Transition& transition, TimePoint deadline) override;
  Result<void> commit() override;
  void conclude(const model::Transition& transition) override;
  void withdraw() override;

  /// Carries out one action for a batch. Hooks run in the caller's thread; one that hangs blocks it.
  Result<void> carry_out(const model::Action& action, TimePoint deadline);
  /// Hooks run on threads of the host; one that hangs keeps its own. Actions without hooks are carried out in
  /// the caller's thread.
  void begin_all(std::vector<model::Action> actions, TimePoint deadline, Completion completed) override;
  [[nodiscard]] model::Network observe() const override;
  [[nodiscard]] std::vector<TaskReport> tasks() const override;
  [[nodiscard]] std::vector<ConnectionReport> connections() const override;
  Result<model::ComponentModel> describe(const model::TaskId& task) const override;
  Result<type::Value> properties(const model::TaskId& task) const override;
  void watch(const LevelQuestion& question, const Wait& wait, LevelAnswer answered) override;
  Result<TaskDetails> details(const model::TaskId& task) const override;
  Result<void> set_property(const model::TaskId& task, std::string_view path, const type::Value& value,
                            TimePoint deadline) override;
  Result<type::Value> call(const model::TaskId& task, std::string_view operation,
                           const type::Value& arguments, TimePoint deadline) override;
  Result<std::unique_ptr<PortReader>> open_reader(const model::PortRef& port, std::size_t buffer) override;
  Result<void> write(const model::PortRef& port, const type::Value& value, TimePoint deadline) override;
  void set_listener(Listener listener) override;

  /// Calls `use` with a port that is to be connected with another process, and returns its result. The port
  /// exists until `use` returns; a stand-in gets a port that it lacks. `use` must be brief and must not call
  /// back. DeadlineExceeded while a hook that creates or removes ports runs, NotFound with the names of the
  /// ports.
  Result<void> with_output(const model::PortRef& port, TimePoint deadline,
                           const std::function<Result<void>(task::OutputPortBase&)>& use);
  Result<void> with_input(const model::PortRef& port, TimePoint deadline,
                          const std::function<Result<void>(task::InputPortBase&)>& use);

  /// The commit of a transition that a runtime in another process executes. The gate is open as soon as
  /// `word` holds `number`; connections to other processes share it. `ending`: connections of this process
  /// that end with it. settle() follows when the transition has committed or was given up.
  task::CommitGatePtr arm_commit(std::shared_ptr<const task::CommitWord> word, std::uint64_t number,
                                 std::span<const model::Connection> ending);
  task::CommitGatePtr gate();
  void settle();
  /// Waits, before an endpoint is closed, until the reader has taken what the connection owes it.
  void let_reader_finish(const sample_link::PortConnection& connection, const model::TaskId& reader,
                         TimePoint deadline) const;

  /// A hook that hangs keeps the caller's thread.
  Result<std::optional<task::SavedState>> save_state(const model::TaskId& task, TimePoint deadline) override;
  Result<void> restore_state(const model::TaskId& task, const task::SavedState& state,
                             TimePoint deadline) override;

  /// Tasks with a hook, an update or an operation that has not returned by its deadline, and which it is.
  /// observe() and tasks() report them as Fatal.
  [[nodiscard]] std::map<model::TaskId, std::string> hanging() const;
  /// False while something that hangs keeps a task, removed ones included: the destructor waits for it.
  [[nodiscard]] bool at_rest() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::task_host
