// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>
#include <segue/solve/component_facts.hpp>
#include <segue/solve/hash_index.hpp>

#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace segue::solve::detail {

/// Simulates a robot: processes, tasks, connections, and the rules of their life cycle. A task may have two
/// incarnations for a while: recover, stop, cleanup and disconnect concern the old one, all other actions the
/// new one. Points into the network, the catalog and the executed actions, which must outlive it.
class Simulation {
 public:
  /// Fails (InvalidArgument) where `current` contradicts itself.
  static Result<Simulation> create(const model::Network& current, const model::ComponentCatalog& catalog);

  /// Executes the action. Fails (InvalidState) with the violated rule; the caller adds the position in the
  /// list.
  Result<> execute(const model::Action& action);
  /// Removes a task from the network. It must be at rest, or have ended with its process.
  Result<> remove(const model::TaskId& id);
  /// Changes a definition without an action.
  Result<> redefine(const model::Task& definition);
  /// The present network. Fails (InvalidState) if an old incarnation is left, which no network can express.
  Result<model::Network> network() const;

 private:
  struct Process {
    const model::Deployment* deployment;
    bool running = true;
    std::vector<int> tasks;  ///< incarnations that ever lived in it
  };
  struct Instance {
    const model::Task* definition;
    ComponentFacts component;
    int id;  ///< the number of its id
    int process;
    std::string_view name;
    TaskState state = TaskState::PreOperational;
    bool exists = true;
    int first_connection = kNone;  ///< of those that ever ended here
  };
  struct StoredConnection {
    const model::Connection* connection;
    int from;
    int to;
    bool exists = true;
    int next_of_from = kNone;  ///< the next connection of the task that it comes from
    int next_of_to = kNone;
  };
  /// The incarnations of one id.
  struct Pair {
    int going = kNone;
    int newest = kNone;
  };
  /// Key of connections: the numbers of two ids, and the ports.
  struct Ends {
    int from;
    int to;
    const model::Connection* connection;
    [[nodiscard]] std::size_t hash() const;
  };

  Simulation(const model::ComponentCatalog& catalog, Interner ids);

  Result<> change_state(const model::Action& action);
  Result<> hand_over(const model::HandOverAction& action) const;
  Result<> call(const model::CallAction& action) const;
  Result<> leave_configured(int task);
  Result<> claim_devices(int task);
  void release_devices(int task);
  Result<> connect(const model::Connection& connection);
  Result<> disconnect(const model::Connection& connection);
  Result<> deploy(const model::Deployment& deployment);
  Result<> undeploy(const model::DeploymentAction& action);
  Result<> apply(const model::ConfigAction& action);
  Result<> apply_again(int task, const model::ConfigAction& action);
  Result<> take_place(int occupant, int process, const model::ConfigAction& action);
  Result<> make_going(Pair& pair);

  int add_task(const model::Task& definition, int process, std::string_view name);
  void add_connection(const model::Connection& connection, int from, int to);
  void drop_connection(int connection);
  void drop_task(int task);

  [[nodiscard]] int find_process(const model::DeploymentKey& key) const;
  [[nodiscard]] int find_occupant(int process, std::string_view name) const;
  [[nodiscard]] int find_newest(const model::TaskId& id) const;
  [[nodiscard]] int newest_of(const Pair& pair) const;
  [[nodiscard]] int subject_of(const model::Action& action) const;
  /// The incarnation that recover, stop and cleanup mean: the old one, or the only one.
  [[nodiscard]] int find_going(const model::TaskId& id) const;
  [[nodiscard]] bool is_resting(int task) const;
  [[nodiscard]] bool is_newest(int task) const;
  [[nodiscard]] bool has_connection(int task) const;
  [[nodiscard]] std::vector<std::string> devices_of(int task) const;

  /// The existing connections between these ports, of any incarnations of the tasks.
  [[nodiscard]] std::vector<int> connections_between(const model::Connection& connection) const;

  [[nodiscard]] int next_connection(int connection, int task) const {
    const StoredConnection& known = connections_[as_index(connection)];
    return known.from == task ? known.next_of_from : known.next_of_to;
  }
  Instance& task(int number) { return tasks_[as_index(number)]; }
  [[nodiscard]] const Instance& task(int number) const { return tasks_[as_index(number)]; }

  KnownComponents components_;
  std::vector<Process> processes_;  ///< the runtime's own first
  std::vector<Instance> tasks_;
  std::vector<StoredConnection> connections_;
  Interner ids_;
  std::vector<Pair> pairs_;  ///< by the number of the id
  HashIndex process_numbers_;
  HashIndex occupants_;
  HashIndex connections_by_ends_;
  std::unordered_map<std::string, int> holders_;  ///< per device
};

}  // namespace segue::solve::detail
