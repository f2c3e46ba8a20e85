// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/base/varied_duration.hpp>
#include <segue/mission/program.hpp>
#include <segue/mission_engine/runners.hpp>
#include <segue/mission_robot/observing_runner.hpp>

#include <algorithm>
#include <unordered_set>

namespace segue::mission {

using type::Value;

namespace {

/// Runs simulated actions, and by `expect` those that are simulated on request.
class Simulation final : public ActionRunner {
 public:
  Simulation(bool as_expected, std::uint64_t seed) : as_expected_(as_expected), seed_(seed) {}

  std::optional<Ending> start(ActionCall& call) override {
    if (call.backward()) return Ending{};
    const Action& action = call.action();
    const auto* declared = std::get_if<Simulated>(&action.run);
    if (as_expected_ || declared == nullptr) {
      const Outcome outcome = call.outcome(action.expected_outcome).value_or(0);
      return after(call, action.expected_duration.value_or(Duration::zero()), {outcome, {}});
    }
    for (const PortValue& output : declared->outputs)
      call.set_output(output.port, output.value);
    Ending ending;
    if (!declared->outcomes.empty()) {
      const std::size_t turn = std::min<std::size_t>(call.iteration(), declared->outcomes.size() - 1);
      ending.outcome = call.outcome(declared->outcomes[turn]).value_or(kAborted);
    }
    if (ending.outcome == kAborted)
      ending.error = declared->error.empty() ? "simulated failure" : declared->error;
    return after(call, declared->duration, std::move(ending));
  }

 private:
  std::optional<Ending> after(ActionCall& call, Duration duration, Ending ending) const {
    if (duration == Duration::zero()) return ending;
    const bool varies = seed_ != 0;
    call.end_after(varies ? varied(duration, seed_, call.path(), call.iteration()) : duration,
                   std::move(ending));
    return std::nullopt;
  }

  const bool as_expected_;
  const std::uint64_t seed_;
};

class Decisions final : public ActionRunner {
 public:
  std::optional<Ending> start(ActionCall& call) override {
    const auto& decision = std::get<Decision>(call.action().run);
    for (const DecisionRule& rule : decision.rules) {
      const bool fits = std::ranges::all_of(rule.when, [&](const auto& when) { return holds(call, when); });
      if (fits) return Ending{call.outcome(rule.outcome).value_or(kAborted), {}};
    }
    return Ending{kAborted, "none of its rules matches how the states ended: " + listed(endings(call))};
  }

 private:
  /// "drive aborted (controller 'go_to' was lost)", of each state.
  static std::vector<std::string> endings(const ActionCall& call) {
    std::vector<std::string> texts;
    for (const BranchResult& branch : call.branches()) {
      texts.push_back(call.program().state(branch.state).id.str() + " " +
                      call.program().outcome_name(branch.state, branch.outcome) +
                      (branch.error.empty() ? "" : " (" + branch.error + ")"));
    }
    return texts;
  }

  static bool holds(const ActionCall& call, const std::pair<std::string, std::string>& when) {
    return std::ranges::any_of(call.branches(), [&](const BranchResult& branch) {
      return call.program().state(branch.state).id.str() == when.first &&
             call.program().outcome_name(branch.state, branch.outcome) == when.second;
    });
  }
};

class FunctionRunner final : public ActionRunner {
 public:
  explicit FunctionRunner(Function function) : function_(std::move(function)) {}
  std::optional<Ending> start(ActionCall& call) override { return function_(call); }

 private:
  Function function_;
};

}  // namespace

Runners::Runners()
    : simulation_(std::make_shared<Simulation>(false, 0)),
      expectation_(std::make_shared<Simulation>(true, 0)),
      decisions_(std::make_shared<Decisions>()) {}
Runners::~Runners() = default;

void Runners::add(const std::string& callback, Function function) {
  add(callback, std::make_shared<FunctionRunner>(std::move(function)));
}
void Runners::add(const std::string& callback, std::shared_ptr<ActionRunner> runner) {
  callbacks_[callback] = std::move(runner);
}
void Runners::set_scripts(std::shared_ptr<ActionRunner> runner) {
  scripts_ = std::move(runner);
}
void Runners::set_controllers(std::shared_ptr<ActionRunner> runner) {
  controllers_ = std::move(runner);
}
void Runners::set_pools(std::shared_ptr<ActionRunner> runner) {
  pools_ = std::move(runner);
}
void Runners::set_observer(std::shared_ptr<FactObserver> observer) {
  observer_ = std::move(observer);
}
void Runners::simulate_all() {
  simulate_all_ = true;
}
void Runners::run_all_by(std::shared_ptr<ActionRunner> runner) {
  one_for_all_ = std::move(runner);
}
void Runners::vary_durations(std::uint64_t seed) {
  simulation_ = std::make_shared<Simulation>(false, seed);
  expectation_ = std::make_shared<Simulation>(true, seed);
}

Result<void> Runners::go_on(const Action& action, const Value& progress) const {
  auto runner = runner_of(action);
  return runner ? (*runner)->go_on(action, progress) : runner.error();
}

Result<std::vector<std::shared_ptr<ActionRunner>>> Runners::assign(const Mission& mission) const {
  std::vector<std::shared_ptr<ActionRunner>> result;
  result.reserve(mission.actions.size());
  std::unordered_set<const ActionRunner*> checked;
  for (const Action& action : mission.actions) {
    auto runner = runner_of(action);
    if (!runner) return runner.error();
    if (checked.insert(runner->get()).second) {
      if (auto usable = (*runner)->check(); !usable) return usable.error();
    }
    if (observer_) *runner = std::make_shared<ObservingRunner>(std::move(*runner), observer_);
    result.push_back(std::move(*runner));
  }
  return result;
}

namespace {

/// Why nothing runs such an action.
std::string_view why_not(const Procedure& run) {
  if (std::holds_alternative<Script>(run)) return ": this program runs no scripts; simulate it";
  if (std::holds_alternative<ControllerUse>(run))
    return ": it is a controller, and there is no robot; run the mission with --robot, or simulate it";
  if (std::holds_alternative<PoolCall>(run))
    return ": it is a call of a pool, and there is no robot; run the mission with --robot, or simulate it";
  return " does not say under 'run' how it runs; simulate it, or say it";
}

}  // namespace

Result<std::shared_ptr<ActionRunner>> Runners::runner_of(const Action& action) const {
  const std::string what = "action " + quote(action.name.str());
  if (std::holds_alternative<Decision>(action.run)) return decisions_;
  if (one_for_all_) return one_for_all_;
  if (std::holds_alternative<Simulated>(action.run)) return simulation_;
  if (simulate_all_) return expectation_;
  if (const auto* callback = std::get_if<Callback>(&action.run)) {
    const auto found = callbacks_.find(callback->name);
    if (found != callbacks_.end()) return found->second;
    return fail(
        ErrorCode::NotFound,
        what + ": this program has no callback " + quote(callback->name) + "; simulate it, or register one",
        action.name.str(), action.where);
  }
  if (std::holds_alternative<Script>(action.run) && scripts_) return scripts_;
  if (std::holds_alternative<ControllerUse>(action.run) && controllers_) return controllers_;
  if (std::holds_alternative<PoolCall>(action.run) && pools_) return pools_;
  return fail(ErrorCode::NotFound, what + std::string(why_not(action.run)), action.name.str(), action.where);
}

}  // namespace segue::mission
