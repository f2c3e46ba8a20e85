// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/model/component.hpp>
#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>
#include <segue/solve/component_facts.hpp>
#include <segue/solve/hash_index.hpp>

#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace segue::solve::detail {

/// A robot on paper: processes, tasks, wires, and the rules of their life cycle. A task may have two
/// incarnations for a while: recover, stop, cleanup and disconnect concern the one that goes, the other
/// actions the one that comes. Points into the network, the catalog and everything it is asked to do, which
/// must outlive it.
class Simulation {
 public:
  /// Fails (InvalidArgument) where `current` contradicts itself.
  static Result<Simulation> create(const model::Network& current, const model::ComponentCatalog& catalog);

  /// Does it, or says which rule forbids it (InvalidState), without a word about the action's place in the
  /// list.
  Result<> execute(const model::Action& action);
  /// A task leaves the network. It must be at rest, or have gone with its process.
  Result<> remove(const model::TaskId& id);
  /// A definition changes without an action.
  Result<> redefine(const model::Task& definition);
  /// What runs now. Fails (InvalidState) where something runs that no network could name: an old incarnation.
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
    int first_wire = kNone;  ///< of those that ever ended here
  };
  struct Wire {
    const model::Connection* connection;
    int from;
    int to;
    bool exists = true;
    int next_of_from = kNone;  ///< the next wire of the task that it comes from
    int next_of_to = kNone;
  };
  /// The incarnations of one id.
  struct Pair {
    int going = kNone;
    int newest = kNone;
  };
  /// What wires are found by: the numbers of two ids, and the ports.
  struct Ends {
    int from;
    int to;
    const model::Connection* connection;
    [[nodiscard]] std::size_t hash() const;
  };

  Simulation(const model::ComponentCatalog& catalog, Interner ids);

  Result<> change_state(const model::Action& action);
  Result<> hand_over(const model::HandOverAction& action) const;
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
  void add_wire(const model::Connection& connection, int from, int to);
  void drop_wire(int wire);
  void drop_task(int task);

  [[nodiscard]] int find_process(const model::DeploymentKey& key) const;
  [[nodiscard]] int find_occupant(int process, std::string_view name) const;
  [[nodiscard]] int find_newest(const model::TaskId& id) const;
  [[nodiscard]] int newest_of(const Pair& pair) const;
  [[nodiscard]] int subject_of(const model::Action& action) const;
  /// The incarnation that the actions mean that lead out: the one that goes, or the only one.
  [[nodiscard]] int find_going(const model::TaskId& id) const;
  [[nodiscard]] bool is_resting(int task) const;
  [[nodiscard]] bool is_newest(int task) const;
  [[nodiscard]] bool has_wires(int task) const;
  [[nodiscard]] std::vector<std::string> devices_of(int task) const;

  /// The wires that join these ports now, whichever incarnations of the tasks.
  [[nodiscard]] std::vector<int> wires_between(const model::Connection& connection) const;

  [[nodiscard]] int next_wire(int wire, int task) const {
    const Wire& known = wires_[as_index(wire)];
    return known.from == task ? known.next_of_from : known.next_of_to;
  }
  Instance& task(int number) { return tasks_[as_index(number)]; }
  [[nodiscard]] const Instance& task(int number) const { return tasks_[as_index(number)]; }

  KnownComponents components_;
  std::vector<Process> processes_;  ///< the runtime's own first
  std::vector<Instance> tasks_;
  std::vector<Wire> wires_;
  Interner ids_;
  std::vector<Pair> pairs_;  ///< by the number of the id
  HashIndex process_numbers_;
  HashIndex occupants_;
  HashIndex wires_by_ends_;
  std::unordered_map<std::string, int> holders_;  ///< per device
};

}  // namespace segue::solve::detail
