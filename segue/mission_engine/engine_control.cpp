// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_engine/engine_core.hpp>

#include <algorithm>

namespace segue::mission::detail {

using Phase = Activation::Phase;

namespace {

/// The units are as if the execution, which was at `path`, had never been.
void undo_units(EngineCore& engine, const UnitsUsed& used, const std::string& path) {
  engine.units.undo(used.uses, used.done);
  if (!engine.options.observe_units) return;
  UnitChanges changes = changes_by(used.uses, used.done);
  for (auto& [resource, change] : changes)
    change = -change;
  if (!changes.empty()) engine.options.observe_units({path}, changes);
}

}  // namespace

/// Whether a breakpoint is at the state that `holder` would begin next; then everything else stops, too.
/// States that an earlier run executed are passed again without stopping.
bool EngineCore::breaks_at(StateIndex state, const Activation& holder) const {
  if (options.journal != nullptr && replayed_count_ < options.journal->size()) return false;
  return breakpoints.has(state, [&] { return next_path(holder); });
}

/// Whether the hierarchy stops before its next child; if so it is added to `held_`.
bool EngineCore::holds(Activation& hierarchy) {
  if (std::exchange(hierarchy.pass, false)) return false;
  const StateIndex next = program->node(hierarchy.state).children[hierarchy.pending.child];
  if (breaks_at(next, hierarchy)) {
    breakpoints.forget_once();
    mode_ = Mode::Hold;
  }
  bool stop = mode_ == Mode::Hold || hierarchy.mark;
  if (mode_ == Mode::Marked && !stop) {
    // Descendants of a marked hierarchy continue; everything else stops.
    stop = true;
    for (const Activation* around = hierarchy.parent; around != nullptr && stop; around = around->parent)
      stop = !around->mark;
  }
  if (stop) hold(hierarchy);
  return stop;
}

/// Concurrent states begin together, so only a breakpoint stops one of them.
bool EngineCore::holds_branch(Activation& branch) {
  if (branch.preempted || std::exchange(branch.pass, false) || !breaks_at(branch.state, branch)) return false;
  breakpoints.forget_once();
  mode_ = Mode::Hold;
  hold(branch);
  return true;
}

/// Tells which states are held, before the engine waits for others that run beside them.
void EngineCore::tell_held() {
  if (std::exchange(held_changed_, false) && !held_.empty() && options.on_held) options.on_held();
}

void EngineCore::hold(Activation& hierarchy) {
  hierarchy.held = true;
  held_changed_ = true;
  held_.push_back(&hierarchy);
}

void EngineCore::let_go(Activation& activation) {
  activation.held = false;
  held_changed_ = true;
  std::erase(held_, &activation);
  ready_.push_back(&activation);
}

void EngineCore::release(Mode mode) {
  mode_ = mode;
  at_rest = false;
  if (mode != Mode::Marked) {
    for (Activation& activation : pool_)
      activation.mark = false;
  }
  for (Activation* activation : std::exchange(held_, {})) {
    activation->held = false;
    activation->pass = true;
    ready_.push_back(activation);
  }
}

/// Marks the held hierarchies, or with `outside` the nearest hierarchy that encloses each.
void EngineCore::mark_held(bool outside) {
  for (Activation& activation : pool_)
    activation.mark = false;
  for (Activation* activation : held_) {
    if (outside) {
      activation = activation->parent;
      while (activation != nullptr && program->node(activation->state).kind != StateKind::Hierarchy)
        activation = activation->parent;
    }
    if (activation != nullptr) activation->mark = true;
  }
}

/// The path of the next state; of a concurrent state that is held before it begins, its own.
std::string EngineCore::next_path(const Activation& holder) const {
  std::string around = path(holder);
  if (holder.phase == Phase::Begin) return around;
  const StateIndex child = program->node(holder.state).children[holder.pending.child];
  return (around.empty() ? "" : around + "/") + program->state(child).id.str();
}

std::vector<std::string> EngineCore::held_at() const {
  std::vector<std::string> paths;
  for (const Activation* activation : held_)
    paths.push_back(next_path(*activation));
  return paths;
}

void EngineCore::remember(Activation& hierarchy, Activation& child) {
  UndoRecord record{program->node(child.state).position,
                    child.item,
                    {},
                    child.changed,
                    child.refused,
                    std::move(child.units),
                    std::move(replaced_),
                    hierarchy.last,
                    hierarchy.error,
                    nullptr};
  replaced_.clear();
  const StateKind kind = program->node(child.state).kind;
  if (is_container(kind) || kind == StateKind::Library) {
    record.kept = &child;
  } else {
    record.inputs = std::move(child.inputs);
    free(child);
  }
  hierarchy.undo.push_back(std::move(record));
}

Result<void> EngineCore::step_back() {
  if (!options.backward) {
    return fail(ErrorCode::InvalidState, "stepping back was not enabled; run with `backward`");
  }
  if (!at_rest || held_.empty())
    return fail(ErrorCode::InvalidState, "the mission is not paused, or what was under way still is");
  auto hierarchy = out_to_something_done(*held_.back());
  if (!hierarchy) return hierarchy.error();
  undoing_ = true;
  undo_at(**hierarchy);
  undoing_ = false;
  for (auto& task : std::exchange(postponed_tasks_, {}))
    mailbox->request(std::move(task));
  return {};
}

/// The hierarchy itself, or the nearest enclosing one with something to undo; those in between are left
/// through their beginning.
Result<Activation*> EngineCore::out_to_something_done(Activation& hierarchy) {
  Activation* child = nullptr;
  Activation* around = &hierarchy;
  while (around != nullptr && around->undo.empty()) {
    if (is_concurrency(program->node(around->state).kind)) {
      return fail(ErrorCode::NotFound, "the preceding step lies outside the concurrent states");
    }
    child = around;
    around = around->parent;
  }
  if (around == nullptr) {
    return fail(ErrorCode::NotFound,
                "no action has been executed since the mission began, or since it was told where to go on");
  }
  held_.pop_back();
  hierarchy.held = false;
  if (child == nullptr) return around;
  around->pending = {NextStep::Kind::Child, program->node(child->state).position, 0};
  around->phase = Phase::Proceed;
  around->children.clear();
  for (Activation* inner = &hierarchy; inner != around;) {
    Activation* outer = inner->parent;
    if (inner->item != History::kNone) history.undo(inner->item);
    if (!inner->units.uses.empty()) give_units_back(*inner);
    free(*inner);
    inner = outer;
  }
  return around;
}

/// Undoes the last action of a hierarchy that has one, and holds before that action.
void EngineCore::undo_at(Activation& hierarchy) {
  Activation* at = &hierarchy;
  while (true) {
    UndoRecord record = std::move(at->undo.back());
    at->undo.pop_back();
    restore(*at, record);
    if (record.kept == nullptr) {
      undo_leaf(*at, program->node(at->state).children[record.position], record);
      break;
    }
    Activation* inner = record.kept;
    while (program->node(inner->state).kind == StateKind::Library)
      inner = inner->children.front();
    if (inner->undo.empty()) {
      undo_all(*record.kept);
      forget(*record.kept);
      break;
    }
    // The step back enters the child again, at its end.
    hold_units_again(*record.kept, record.units);
    at->children.assign(1, record.kept);
    at->phase = Phase::Wait;
    at = inner;
  }
  hold(*at);
  mode_ = Mode::Hold;
}

void EngineCore::restore(Activation& hierarchy, UndoRecord& record) {
  for (auto replaced = record.before.rbegin(); replaced != record.before.rend(); ++replaced)
    hierarchy.slots[replaced->first] = std::move(replaced->second);
  hierarchy.last = record.last;
  hierarchy.error = std::move(record.error);
  hierarchy.pending = {NextStep::Kind::Child, record.position, 0};
  hierarchy.phase = Phase::Proceed;
}

/// Calls the backward execution of the action and blocks until it has ended.
void EngineCore::undo_leaf(Activation& around, StateIndex state, const UndoRecord& done) {
  if (done.item != History::kNone) history.undo(done.item);
  if (done.refused) return;
  Activation& leaf = *make(state, &around);
  leaf.inputs = done.inputs;
  for (const PortSource& output : program->node(state).outputs)
    leaf.outputs.push_back(fallback(output));
  backward_ = true;
  bool under_way = false;
  (void)call(leaf, under_way);
  backward_ = false;
  if (under_way) {
    leaf.phase = Phase::Wait;
    while (leaf.phase == Phase::Wait) {
      wait();
      read_messages();
    }
    std::erase(ready_, &leaf);
  }
  const std::string at = path(leaf);
  free(leaf);
  world.undo(done.changed);
  undo_units(*this, done.units, at);
}

/// Undoes every action inside, last one first; of concurrent branches, the last branch first.
void EngineCore::undo_all(Activation& kept) {
  struct Work {
    Activation* activation;
    const UndoRecord* record;
  };
  std::vector<Work> open = {{&kept, nullptr}};
  while (!open.empty()) {
    const Work work = open.back();
    open.pop_back();
    if (work.record != nullptr && work.record->kept == nullptr) {
      const StateIndex state = program->node(work.activation->state).children[work.record->position];
      undo_leaf(*work.activation, state, *work.record);
      continue;
    }
    Activation& inside = work.record == nullptr ? *work.activation : *work.record->kept;
    const StateKind kind = program->node(inside.state).kind;
    if (inside.item != History::kNone) history.undo(inside.item);
    if (kind == StateKind::Decider) {
      world.undo(inside.changed);
      undo_units(*this, inside.units, path(inside));
    } else if (is_leaf(kind)) {
      undo_leaf(*inside.parent, inside.state,
                {0, inside.item, inside.inputs, inside.changed, inside.refused, inside.units});
    }
    for (Activation* child : inside.children)
      open.push_back({child, nullptr});
    for (const UndoRecord& record : inside.undo)
      open.push_back({&inside, &record});
  }
}

/// Returns a kept activation and everything inside it to the pool.
void EngineCore::forget(Activation& kept) {
  std::vector<Activation*> open = {&kept};
  while (!open.empty()) {
    Activation& activation = *open.back();
    open.pop_back();
    open.insert(open.end(), activation.children.begin(), activation.children.end());
    for (const UndoRecord& record : activation.undo) {
      if (record.kept != nullptr) open.push_back(record.kept);
    }
    free(activation);
  }
}

}  // namespace segue::mission::detail
