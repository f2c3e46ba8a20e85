// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>
#include <segue/convert/action_environment.hpp>
#include <segue/convert/concurrent_run.hpp>
#include <segue/convert/run_events.hpp>
#include <segue/convert/unfinished_outputs.hpp>
#include <segue/convert/world_views.hpp>
#include <segue/mission_robot/fact_observer.hpp>
#include <segue/mission_script/scripted_data.hpp>

#include <algorithm>
#include <utility>

namespace segue::convert {

namespace {

/// A plan, and whoever follows or records the actions whose ends count.
class ObservedPlan final : public task_network::Expansion {
 public:
  /// `journal` may be null.
  ObservedPlan(MissionPlan& plan, RunEvents& events, NodeJournal* journal)
      : plan_(plan), events_(events), journal_(journal) {}
  void expand(task_network::TaskNetwork& network, std::size_t wanted) override {
    plan_.expand(network, wanted);
    events_.settle();
  }
  void failed(task_network::NodeId node) override { plan_.failed(node); }
  void skipped(task_network::NodeId node) override {
    plan_.skipped(node);
    events_.settle();
  }
  [[nodiscard]] bool races() const override { return plan_.races(); }
  [[nodiscard]] std::vector<task_network::NodeId> take_lost() override { return plan_.take_lost(); }
  [[nodiscard]] bool finished() const override { return plan_.finished(); }
  void ended(task_network::NodeId node, task_network::OutcomeId outcome,
             const type::Value* outputs) override {
    if (journal_ != nullptr) journal_->ended(node, outcome, outputs);
    events_.ended(node, outcome, outputs);
    plan_.ended(node, outcome, outputs);
    events_.settle();
  }

 private:
  MissionPlan& plan_;
  RunEvents& events_;
  NodeJournal* const journal_;
};

/// Opaque subtrees report from threads of their own.
mission::StateObserver one_at_a_time(mission::StateObserver observe) {
  if (!observe) return {};
  return [observe = std::move(observe), mutex = std::make_shared<Mutex>()](const mission::StateEvent& event) {
    const Lock lock(*mutex);
    observe(event);
  };
}

void mark_observed(const mission::Mission& mission, task_network::FactTable& facts) {
  for (const mission::ObservedFact& one : mission.observed) {
    const auto grounded = mission::ground(one.fact);
    const auto fact = grounded ? facts.intern_named(grounded->text) : grounded.error();
    if (fact) facts.mark_observed(*fact);
  }
}

/// Hands the units that a robot shows to an engine, while it runs. Shared with who looks at the robot.
struct LimitReceiver {
  Mutex mutex;
  task_network::ConcurrentEngine* engine SEGUE_GUARDED_BY(mutex) = nullptr;

  void limit(task_network::UnitLimits limits) {
    const Lock lock(mutex);
    if (engine != nullptr) engine->limit(std::move(limits));
  }
  void serve(task_network::ConcurrentEngine* by) {
    const Lock lock(mutex);
    engine = by;
  }
};

using ObservedResources = std::vector<std::pair<task_network::ResourceId, const mission::Resource*>>;

/// The resources of a plan of which a robot shows the units; none in virtual time.
ObservedResources observed_resources(const MissionPlan& plan, const mission::Runners& runners,
                                     const RunOptions& options) {
  ObservedResources observed;
  if (!runners.observer() || options.clock == task_network::ClockKind::Virtual) return observed;
  for (const mission::Resource& resource : plan.program().mission().resources) {
    if (!resource.observe) continue;
    if (const auto id = plan.network().resources.find(resource.name)) observed.emplace_back(*id, &resource);
  }
  return observed;
}

}  // namespace

class Run::Implementation {
 public:
  Implementation(std::unique_ptr<MissionPlan> plan, const mission::Runners& runners,
                 std::vector<std::shared_ptr<mission::ActionRunner>> by_action, const RunOptions& options)
      : plan_(std::move(plan)),
        runners_(runners),
        journal_(options.journal ? std::make_unique<NodeJournal>(*plan_, options.journal) : nullptr),
        events_(*plan_, options),
        environment_(*plan_, runners_, std::move(by_action), options, {journal_.get(), &events_}),
        observed_(*plan_, events_, journal_.get()),
        units_(observed_resources(*plan_, runners_, options)),
        engine_(plan_->network(), observed_, environment_, settings(options)) {
    if (journal_) plan_->set_race_record(journal_->races());
  }

  const mission::MissionResult& run() {
    const auto watched = watch_units();
    network_result_ = engine_.run();
    limits_->serve(nullptr);
    environment_.close();
    events_.finish(network_result_);
    const mission::Program& program = plan_->program();
    result_.outcome = plan_->final_outcome(network_result_);
    result_.outcome_name = program.outcome_name(0, result_.outcome);
    if (network_result_.error && result_.outcome == mission::kAborted)
      result_.error = network_result_.error->message;
    else if (result_.outcome != mission::kPreempted)
      result_.error = plan_->final_error();
    result_.outputs = result_.outcome >= 0
                          ? plan_->final_outputs()
                          : unfinished_outputs(*plan_, network_result_, environment_.globals);
    result_.outputs.resize(program.node(0).output_ports->size());
    if (journal_ && !network_result_.stopped) journal_->finished(result_.outcome_name);
    return result_;
  }

  [[nodiscard]] task_network::ConcurrentEngineOptions settings(const RunOptions& options) const {
    task_network::ConcurrentEngineOptions made;
    if (options.held) {
      made.held = [this, told = options.held](const std::vector<task_network::NodeId>& next) {
        std::vector<std::string> paths;
        for (const task_network::NodeId node : next)
          paths.emplace_back((*plan_)[node].path);
        told(paths);
      };
    }
    for (const auto& [id, resource] : units_)
      made.limited.push_back(id);
    made.waits_for_units = [this, warn = options.warn](const task_network::ResourcePool::Limited& wait) {
      const auto is_meant = [&](const auto& one) { return one.first == wait.resource; };
      const mission::Resource& resource = *std::ranges::find_if(units_, is_meant)->second;
      const std::string why = unshown_text(resource.name, *resource.observe, wait.count, wait.limit);
      if (warn) warn(plan_->network().label(wait.node) + ": " + why);
    };
    made.clock = options.clock;
    made.strict = options.strict;
    made.speculate = options.speculate;
    made.workers = options.workers;
    made.world_copies = options.world_copies;
    made.ahead = options.ahead;
    made.least_likelihood = options.least_likelihood;
    made.horizon = options.horizon;
    made.log = options.log;
    return made;
  }

  /// Has the engine follow the units that the robot shows, until what this returns is gone.
  [[nodiscard]] std::shared_ptr<void> watch_units() {
    if (units_.empty()) return nullptr;
    limits_->serve(&engine_);
    return runners_.observer()->watch_units(
        [limits = limits_, units = units_](const mission::ShownUnits& shown) {
          task_network::UnitLimits now{{}, shown.lost};
          for (const auto& [id, resource] : units)
            now.units.emplace_back(id, shown.units.find(resource->name)->second);
          limits->limit(std::move(now));
        });
  }

  std::unique_ptr<MissionPlan> plan_;
  const mission::Runners runners_;
  const std::unique_ptr<NodeJournal> journal_;
  RunEvents events_;
  ActionEnvironment environment_;
  ObservedPlan observed_;
  const ObservedResources units_;
  task_network::ConcurrentEngine engine_;
  const std::shared_ptr<LimitReceiver> limits_ = std::make_shared<LimitReceiver>();
  task_network::RunResult network_result_;
  mission::MissionResult result_;
};

Run::Run(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
Run::~Run() = default;

Result<std::unique_ptr<Run>> Run::create(std::shared_ptr<const mission::Program> program,
                                         const mission::Runners& runners, std::vector<type::Value> inputs,
                                         RunOptions options) {
  auto assigned = runners.assign(program->mission());
  if (!assigned) return assigned.error();
  options.observe = one_at_a_time(std::move(options.observe));
  auto plan = MissionPlan::create(std::move(program), std::move(inputs), options.facts, PlanScope::AsKnown,
                                  options.resources);
  if (!plan) return plan.error();
  if (auto attached = mission::attach_declared((*plan)->program().mission(), options.world_data); !attached)
    return attached.error();
  auto& network = (*plan)->network();
  attach(network.initial_world, network.facts, options.world_data);
  if (runners.observer()) {
    const mission::Mission& mission = (*plan)->program().mission();
    if (const auto facts = mission::initial_facts(mission, options.facts)) runners.observer()->begin(*facts);
    mark_observed(mission, network.facts);
  }
  return std::unique_ptr<Run>(
      new Run(std::make_unique<Implementation>(std::move(*plan), runners, std::move(*assigned), options)));
}

const mission::MissionResult& Run::run() {
  return implementation_->run();
}
void Run::stop() {
  implementation_->engine_.stop();
  implementation_->environment_.stop();
}
void Run::pause() {
  implementation_->engine_.pause();
}
void Run::resume() {
  implementation_->engine_.resume();
}
void Run::step() {
  implementation_->engine_.step();
}
const task_network::RunResult& Run::network_result() const {
  return implementation_->network_result_;
}
const task_network::Order& Run::order() const {
  return implementation_->engine_.order();
}
const MissionPlan& Run::plan() const {
  return *implementation_->plan_;
}
mission::Globals& Run::globals() {
  return implementation_->environment_.globals;
}

namespace {

/// A plan that has come to its end, as far as an engine is told, when there are so many nodes.
class Bounded final : public task_network::Expansion {
 public:
  Bounded(MissionPlan& plan, std::size_t most) : plan_(plan), most_(most) {}
  void expand(task_network::TaskNetwork& network, std::size_t wanted) override {
    if (network.size() < most_) plan_.expand(network, std::min(wanted, most_ - network.size()));
  }
  void ended(task_network::NodeId node, task_network::OutcomeId outcome,
             const type::Value* outputs) override {
    plan_.ended(node, outcome, outputs);
  }
  void failed(task_network::NodeId node) override { plan_.failed(node); }
  void skipped(task_network::NodeId node) override { plan_.skipped(node); }
  [[nodiscard]] bool races() const override { return plan_.races(); }
  [[nodiscard]] std::vector<task_network::NodeId> take_lost() override { return plan_.take_lost(); }
  [[nodiscard]] bool finished() const override { return plan_.finished() || plan_.network().size() >= most_; }

 private:
  MissionPlan& plan_;
  const std::size_t most_;
};

}  // namespace

Result<std::optional<Error>> plan_ahead(MissionPlan& plan, std::size_t most,
                                        const mission::Runners* assumed) {
  if (assumed == nullptr) {
    plan.expand(plan.network(), most);
    return std::optional<Error>();
  }
  auto by_action = assumed->assign(plan.program().mission());
  if (!by_action) return by_action.error();
  RunOptions options;
  options.clock = task_network::ClockKind::Virtual;
  ActionEnvironment environment(plan, *assumed, std::move(*by_action), options);
  Bounded bounded(plan, most);
  task_network::ConcurrentEngineOptions settings;
  settings.clock = task_network::ClockKind::Virtual;
  settings.horizon = most;
  task_network::ConcurrentEngine engine(plan.network(), bounded, environment, settings);
  task_network::RunResult result = engine.run();
  environment.close();
  return std::move(result.error);
}

}  // namespace segue::convert
