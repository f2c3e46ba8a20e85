// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/mission/action_runner.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

namespace segue::mission {

/// An action as a C++ function that has ended when it returns. An exception aborts it.
using Function = std::function<Ending(ActionCall&)>;

class FactObserver;
struct Mission;

/// Assigns runners to actions: callbacks by name; simulated actions and decisions are built in. Copies share
/// the runners.
class Runners {
 public:
  Runners();
  ~Runners();

  void add(const std::string& callback, Function function);
  void add(const std::string& callback, std::shared_ptr<ActionRunner> runner);
  /// The runner of all actions with a script, such as a ScriptRunner.
  void set_scripts(std::shared_ptr<ActionRunner> runner);
  /// The runner of all actions that are controllers, such as a ControllerRunner.
  void set_controllers(std::shared_ptr<ActionRunner> runner);
  /// The runner of all actions that are calls of a pool, such as a PoolRunner.
  void set_pools(std::shared_ptr<ActionRunner> runner);
  /// Compares observed facts with a robot (ObservedFact); without an observer they are facts like all others.
  /// It must outlive the runs.
  void set_observer(std::shared_ptr<FactObserver> observer);
  /// Null: none.
  [[nodiscard]] const std::shared_ptr<FactObserver>& observer() const { return observer_; }
  /// Simulates every action except deciders by its `expect`, whatever its `run` says.
  void simulate_all();
  /// Makes `runner` run every action except deciders, whatever its `run` says: so a run can be repeated with
  /// the durations that were measured in another one.
  void run_all_by(std::shared_ptr<ActionRunner> runner);
  /// Simulated actions take between half and twice as long, the same for the same seed, state and turn of
  /// that state; 0: as declared.
  void vary_durations(std::uint64_t seed);

  /// ActionRunner::go_on() of the action's runner.
  [[nodiscard]] Result<void> go_on(const Action& action, const type::Value& progress) const;
  /// The runner of each action of the mission; NotFound if an action has none, or one that lacks what it
  /// needs.
  [[nodiscard]] Result<std::vector<std::shared_ptr<ActionRunner>>> assign(const Mission& mission) const;

 private:
  [[nodiscard]] Result<std::shared_ptr<ActionRunner>> runner_of(const Action& action) const;

  std::unordered_map<std::string, std::shared_ptr<ActionRunner>> callbacks_;
  std::shared_ptr<ActionRunner> scripts_;
  std::shared_ptr<ActionRunner> controllers_;
  std::shared_ptr<ActionRunner> pools_;
  std::shared_ptr<ActionRunner> simulation_;
  std::shared_ptr<ActionRunner> expectation_;
  std::shared_ptr<ActionRunner> decisions_;
  std::shared_ptr<ActionRunner> one_for_all_;  ///< null: each action has its own
  std::shared_ptr<FactObserver> observer_;
  bool simulate_all_ = false;
};

}  // namespace segue::mission
