// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/base/time_after.hpp>
#include <segue/mission/mission_index.hpp>
#include <segue/mission_engine/engine_core.hpp>

#include <exception>

namespace segue::mission::detail {

using Phase = Activation::Phase;

namespace {

bool aborts(const NextStep& step) {
  return step.kind == NextStep::Kind::Leave && step.outcome == kAborted;
}

}  // namespace

/// The execution of a leaf as its runner sees it.
class EngineCore::LeafCall final : public ActionCall {
 public:
  LeafCall(EngineCore& engine, Activation& activation) : engine_(engine), activation_(activation) {}
  [[nodiscard]] StateIndex state() const override { return activation_.state; }
  [[nodiscard]] const Program& program() const override { return *engine_.program; }
  [[nodiscard]] std::string path() const override { return engine_.path(activation_); }
  [[nodiscard]] std::span<const type::Value> inputs() const override { return activation_.inputs; }
  [[nodiscard]] std::span<type::Value> outputs() override { return activation_.outputs; }
  [[nodiscard]] Globals& globals() const override { return engine_.globals; }
  [[nodiscard]] const std::string& error_before() const override { return activation_.error_before; }
  [[nodiscard]] std::span<const BranchResult> branches() const override {
    if (activation_.parent == nullptr) return {};
    return activation_.parent->branches;
  }
  [[nodiscard]] std::uint64_t iteration() const override { return activation_.iteration; }
  [[nodiscard]] const type::Value& progress() const override {
    return engine_.options.journal ? engine_.options.journal->progress(execution()) : ActionCall::progress();
  }
  [[nodiscard]] std::function<void(const type::Value&)> recorder() const override {
    if (!engine_.options.journal) return {};
    return [journal = engine_.options.journal, execution = execution()](const type::Value& progress) {
      journal->progressed(execution, progress);
    };
  }
  [[nodiscard]] const ObservedNeeds* observed() const override {
    return engine_.observer ? activation_.observed.get() : nullptr;
  }
  [[nodiscard]] bool backward() const override { return engine_.backward_; }

  Completer defer(std::function<void()> preempt) override {
    activation_.deferred = true;
    activation_.preempt = std::move(preempt);
    ++engine_.open_calls_;
    return [mailbox = engine_.mailbox, activation = &activation_, generation = activation_.generation](
               Ending ending, std::vector<type::Value> outputs) {
      mailbox->post({activation, generation, std::move(ending), std::move(outputs)});
    };
  }
  void end_after(Duration duration, Ending ending) override {
    const auto when = time_after(engine_.now(), duration);
    activation_.timed = when ? std::move(ending) : Ending{kAborted, when.error().message};
    engine_.timers_.push(
        {when.value_or(engine_.now()), ++engine_.timer_order_, &activation_, activation_.generation});
  }

 private:
  [[nodiscard]] WorldView look_at_world() const override { return engine_.world.view(); }
  [[nodiscard]] Execution execution() const { return {path(), activation_.iteration}; }

  EngineCore& engine_;
  Activation& activation_;
};

Activation* EngineCore::enter(Activation& activation) {
  const CompiledState& node = program->node(activation.state);
  const Activation* outside = activation.parent;
  if (outside != nullptr && is_concurrency(program->node(outside->state).kind) && holds_branch(activation))
    return nullptr;
  ++executions;
  activation.iteration = (*iterations_)[activation.state]++;
  if (options.history) {
    const std::uint32_t around = activation.parent == nullptr ? History::kNone : activation.parent->item;
    activation.item =
        history.begin({around, activation.state, activation.iteration, 0, false, false, now(), {}});
  }
  switch (node.kind) {
    case StateKind::Execution:
    case StateKind::Decider:
      return enter_leaf(activation);
    case StateKind::Library:
      return enter_library(activation);
    case StateKind::Hierarchy:
    case StateKind::Barrier:
    case StateKind::Preemptive:
      break;
  }
  set_up(activation);
  if (node.required == nullptr) return begin_container(activation);
  return activation.preempted ? leave(activation, kPreempted) : ask(activation);
}

Activation* EngineCore::begin_container(Activation& container) {
  if (program->node(container.state).kind != StateKind::Hierarchy) return begin_branches(container);
  first_step(container);
  container.phase = Phase::Proceed;
  return &container;
}

/// The start of the hierarchy, or the child on the path at which the mission was told to start.
void EngineCore::first_step(Activation& hierarchy) {
  hierarchy.pending = program->node(hierarchy.state).start;
  if (aborts(hierarchy.pending)) hierarchy.error = program->start_abort_text(hierarchy.state);
  if (start_path.empty()) return;
  const CompiledState& wanted = program->node(start_path.back());
  if (wanted.parent != hierarchy.state) return;
  hierarchy.pending = {NextStep::Kind::Child, wanted.position, 0};
  start_path.pop_back();
  hierarchy.pass = !start_path.empty();
}

Activation* EngineCore::enter_leaf(Activation& leaf) {
  for (const PortSource& output : program->node(leaf.shown_as).outputs)
    leaf.outputs.push_back(fallback(output));
  if (leaf.preempted) return leave(leaf, kPreempted);
  const bool asks = leaf.around != nullptr || touches_[program->node(leaf.state).action];
  return asks ? ask(leaf) : begin_leaf(leaf);
}

Activation* EngineCore::begin_leaf(Activation& leaf) {
  fill_world_inputs(leaf);
  bool under_way = false;
  const Ending ending = call(leaf, under_way);
  if (under_way) {
    leaf.phase = Phase::Wait;
    return nullptr;
  }
  check(leaf, ending);
  leaf.phase = Phase::Finish;
  return &leaf;
}

/// Declared effects only apply if the action ends with its expected outcome.
void EngineCore::apply_effects(Activation& leaf) {
  const Action& action = program->mission().actions[program->node(leaf.state).action];
  if (program->outcome_name(leaf.state, leaf.outcome) == action.foreseen_outcome())
    leaf.changed = world.apply(leaf.effects, new_values(action, leaf));
}

Ending EngineCore::call(Activation& leaf, bool& under_way) {
  return options.journal == nullptr ? execute(leaf, under_way) : call_with_journal(leaf, under_way);
}

Ending EngineCore::execute(Activation& leaf, bool& under_way) {
  if (options.observe && !backward_) tell_begin(leaf);
  LeafCall execution(*this, leaf);
  try {
    const auto ending = runners[program->node(leaf.state).action]->start(execution);
    under_way = !ending.has_value();
    return ending.value_or(Ending{});
  } catch (const std::exception& exception) {
    return {kAborted, exception.what()};
  } catch (...) {
    return {kAborted, "it threw an object that is not a std::exception"};
  }
}

/// Turns the ending that an action reported into the outcome of its state.
void EngineCore::check(Activation& leaf, const Ending& ending) {
  const auto outcomes = static_cast<Outcome>(program->node(leaf.state).outcomes->size());
  leaf.outcome = ending.outcome;
  leaf.error = ending.error;
  if (leaf.preempted) {
    leaf.outcome = kPreempted;
  } else if (ending.outcome < kPreempted || ending.outcome >= outcomes) {
    leaf.outcome = kAborted;
    leaf.error = "its action ended with an outcome that it does not declare";
  }
  if (leaf.replayed) return;
  leaf.begins_again = options.journal != nullptr && options.journal->is_closed();
  if (options.journal != nullptr) record_end(leaf);
  tell_end(leaf);
}

/// How often the state had begun before; of the root of a library, the state that uses it.
std::uint64_t EngineCore::iteration_of(const Activation& activation) const {
  const Activation* state = &activation;
  while (state->parent != nullptr && program->node(state->parent->state).kind == StateKind::Library)
    state = state->parent;
  return state->iteration;
}

/// Tells the begin of an action.
void EngineCore::tell_begin(const Activation& leaf) {
  tell_around(leaf);
  const std::string at = path(leaf);
  options.observe({.path = at, .iteration = iteration_of(leaf)});
}

/// The begin of the containers around the state of which nothing was told before.
void EngineCore::tell_around(const Activation& state) {
  std::vector<Activation*> begun;
  for (Activation* around = state.parent; around != nullptr && !around->told; around = around->parent) {
    // A library is told by its root, which has the same path, and the mission itself by its result.
    const bool is_mission = around->state == 0;
    if (program->node(around->state).kind != StateKind::Library && !is_mission) begun.push_back(around);
  }
  for (auto around = begun.rbegin(); around != begun.rend(); ++around) {
    (*around)->told = true;
    const std::string at = path(**around);
    options.observe({.path = at, .iteration = iteration_of(**around), .is_container = true});
  }
}

/// Tells the end of an action or of a container.
void EngineCore::tell_end(Activation& activation) {
  if (backward_) return;
  const bool is_retried = !std::exchange(activation.told, false);               // or else something in it is
  const TimePoint when = activation.outcome == kAborted ? now() : TimePoint{};  // the clock costs time
  if (is_retried && retries_.ended(activation.state, activation.outcome, when) && options.warn)
    warn(activation, RetryWatch::warning());
  if (!options.observe) return;
  tell_around(activation);
  const bool is_container = mission::is_container(program->node(activation.state).kind);
  const bool tells_why = !is_container || activation.outcome == kAborted;
  const std::string at = path(activation);
  const std::string outcome = program->outcome_name(activation.state, activation.outcome);
  options.observe({StateEvent::Kind::Ended, at, iteration_of(activation), outcome,
                   tells_why ? std::string_view(activation.error) : std::string_view{}, is_container});
}

Activation* EngineCore::enter_library(Activation& library) {
  Activation* root = make(program->node(library.state).library, &library);
  root->shown_as = library.shown_as;
  root->inputs = std::move(library.inputs);
  root->error_before = library.error_before;
  root->preempted = library.preempted;
  library.inputs.clear();
  library.children.assign(1, root);
  library.phase = Phase::Wait;
  return root;
}

Activation* EngineCore::begin_branches(Activation& concurrency) {
  const CompiledState& node = program->node(concurrency.state);
  concurrency.phase = Phase::Wait;
  if (concurrency.preempted) return leave(concurrency, kPreempted);
  for (const StateIndex state : node.children) {
    if (state == node.decider) continue;
    Activation* child = make(state, &concurrency);
    fill_inputs(*child, concurrency);
    concurrency.children.push_back(child);
    ready_.push_back(child);
  }
  concurrency.open = static_cast<std::uint32_t>(concurrency.children.size());
  return nullptr;
}

/// Begins the next child of a hierarchy, unless the hierarchy is held, preempted or at its end.
Activation* EngineCore::proceed(Activation& hierarchy) {
  const NextStep step = hierarchy.pending;
  if (step.kind == NextStep::Kind::Leave) return leave(hierarchy, step.outcome);
  if (!hierarchy.preempted && holds(hierarchy)) return nullptr;
  // After a preemption only a child runs that handles the preemption of its predecessor.
  if (hierarchy.preempted && hierarchy.last != kPreempted) return leave(hierarchy, kPreempted);
  Activation* child = make(program->node(hierarchy.state).children[step.child], &hierarchy);
  fill_inputs(*child, hierarchy);
  hierarchy.error.clear();
  hierarchy.children.assign(1, child);
  hierarchy.phase = Phase::Wait;
  return child;
}

Activation* EngineCore::leave(Activation& activation, Outcome outcome) {
  activation.outcome = outcome;
  activation.phase = Phase::Finish;
  return &activation;
}

Activation* EngineCore::finish(Activation& activation) {
  const CompiledState& node = program->node(activation.state);
  if (is_container(node.kind)) {
    give_outputs(activation);
    if (activation.preempted) activation.outcome = kPreempted;
    if (!options.backward) free_children(activation);
  }
  if (activation.told || (activation.refused && activation.outcome == kAborted)) tell_end(activation);
  if (!activation.error.empty()) {
    if (const auto port = position(*node.output_ports, "error")) activation.outputs[*port] = activation.error;
  }
  const bool is_action = is_leaf(node.kind);
  if (!activation.effects.empty() || (is_action && changes_values_[node.action])) apply_effects(activation);
  if (!activation.units.uses.empty()) give_units_back(activation);
  if (activation.item != History::kNone)
    history.end(activation.item, activation.outcome, now(), activation.error);
  Activation* around = activation.parent;
  if (around == nullptr) {
    result = {activation.outcome, program->outcome_name(activation.state, activation.outcome),
              activation.error, activation.outputs};
    ended = true;
    if (options.journal != nullptr) options.journal->finished(result.outcome_name);
    return nullptr;
  }
  if (activation.mark) around->mark = true;
  const CompiledState& outer = program->node(around->state);
  if (outer.kind == StateKind::Hierarchy) return child_of_hierarchy(*around, activation);
  if (outer.kind != StateKind::Library) return child_of_concurrency(*around, activation);
  around->outputs = std::move(activation.outputs);
  around->outcome = activation.outcome;
  around->error = activation.error;
  if (!options.backward) {
    around->children.clear();
    free(activation);
  }
  around->phase = Phase::Finish;
  return around;
}

Activation* EngineCore::child_of_hierarchy(Activation& hierarchy, Activation& child) {
  if (take_jump(hierarchy)) {
    hierarchy.children.clear();
    forget(child);
    return &hierarchy;
  }
  const Outcome outcome = child.outcome;
  const StateIndex child_state = child.state;
  replaced_.clear();
  take_outputs(hierarchy, child);
  hierarchy.pending = program->node(child.state).next_after(outcome);
  hierarchy.phase = Phase::Proceed;
  hierarchy.children.clear();
  std::string error = child.error;
  if (options.backward) {
    remember(hierarchy, child);
  } else {
    free(child);
  }
  hierarchy.last = outcome;
  hierarchy.error = std::move(error);
  if (outcome >= 0 && aborts(hierarchy.pending)) hierarchy.error = program->abort_text(child_state, outcome);
  // An unhandled abort or preemption propagates to the parent. Other outcomes always have a transition, since
  // the mission is valid.
  if (hierarchy.pending.kind == NextStep::Kind::Nowhere)
    return leave(hierarchy, outcome == kAborted ? kAborted : kPreempted);
  return &hierarchy;
}

Activation* EngineCore::child_of_concurrency(Activation& concurrency, Activation& child) {
  child.phase = Phase::Done;
  const CompiledState& node = program->node(concurrency.state);
  if (child.state == node.decider) return follow(concurrency, child);
  if (node.kind == StateKind::Preemptive && concurrency.first == nullptr) {
    concurrency.first = &child;
    for (Activation* other : concurrency.children) {
      if (other != &child && !other->preempted) preempt(*other);
    }
  }
  return --concurrency.open == 0 ? join(concurrency) : nullptr;
}

/// Called when all children have ended.
Activation* EngineCore::join(Activation& concurrency) {
  const CompiledState& node = program->node(concurrency.state);
  for (const Activation* child : concurrency.children) {
    take_outputs(concurrency, *child);
    concurrency.branches.push_back({child->state, child->outcome, child->error});
  }
  if (concurrency.preempted) return leave(concurrency, kPreempted);
  if (node.kind == StateKind::Preemptive) {
    take_outputs(concurrency, *concurrency.first);
    return follow(concurrency, *concurrency.first);
  }
  Activation* decider = make(node.decider, &concurrency);
  fill_inputs(*decider, concurrency);
  concurrency.children.push_back(decider);
  return decider;
}

/// Ends the concurrency as the transition of the decisive child says.
Activation* EngineCore::follow(Activation& concurrency, const Activation& child) {
  if (program->node(child.state).kind == StateKind::Decider) take_outputs(concurrency, child);
  const NextStep step = program->node(child.state).next_after(child.outcome);
  if (child.outcome == kAborted) concurrency.error = child.error.empty() ? "state aborted" : child.error;
  if (child.outcome >= 0 && aborts(step)) concurrency.error = program->abort_text(child.state, child.outcome);
  const Outcome outcome = step.kind == NextStep::Kind::Leave ? step.outcome : child.outcome;
  return leave(concurrency, outcome);
}

}  // namespace segue::mission::detail
