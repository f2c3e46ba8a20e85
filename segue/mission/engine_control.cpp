// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/engine_core.hpp>

#include <algorithm>

namespace segue::mission::detail {

using Phase = Activation::Phase;

/// Whether a hierarchy waits before its next child; then it is among the held.
bool EngineCore::holds(Activation& hierarchy) {
  if (std::exchange(hierarchy.pass, false)) return false;
  bool stop = mode_ == Mode::Hold || hierarchy.mark;
  if (mode_ == Mode::Until) stop = next_path(hierarchy) == until;
  if (mode_ == Mode::Marked && !stop) {
    // What is inside of a mark goes on; what is beside or around of all marks stops.
    stop = true;
    for (const Activation* around = hierarchy.parent; around != nullptr && stop; around = around->parent)
      stop = !around->mark;
  }
  if (stop) hold(hierarchy);
  return stop;
}

void EngineCore::hold(Activation& hierarchy) {
  hierarchy.held = true;
  held_.push_back(&hierarchy);
}

void EngineCore::let_go(Activation& activation) {
  activation.held = false;
  std::erase(held_, &activation);
  ready_.push_back(&activation);
}

void EngineCore::release(Mode mode) {
  mode_ = mode;
  if (mode != Mode::Marked) {
    for (Activation& activation : pool_)
      activation.mark = false;
  }
  for (Activation* activation : std::exchange(held_, {})) {
    activation->held = false;
    activation->pass = mode != Mode::Run;
    ready_.push_back(activation);
  }
}

/// Marks what is held, or the nearest hierarchies around it.
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

std::string EngineCore::next_path(const Activation& hierarchy) const {
  const std::string around = path(hierarchy);
  const StateIndex child = program->node(hierarchy.state).children[hierarchy.pending.child];
  return (around.empty() ? "" : around + "/") + program->state(child).id.str();
}

std::vector<std::string> EngineCore::held_at() const {
  std::vector<std::string> paths;
  for (const Activation* activation : held_)
    paths.push_back(next_path(*activation));
  return paths;
}

void EngineCore::remember(Activation& hierarchy, Activation& child) {
  Trail trail{program->node(child.state).position,
              child.item,
              {},
              child.changed,
              child.refused,
              std::move(replaced_),
              hierarchy.last,
              hierarchy.error,
              nullptr};
  replaced_.clear();
  const StateKind kind = program->node(child.state).kind;
  if (is_container(kind) || kind == StateKind::Library) {
    trail.kept = &child;
  } else {
    trail.inputs = std::move(child.inputs);
    free(child);
  }
  hierarchy.trail.push_back(std::move(trail));
}

Result<void> EngineCore::step_back() {
  if (!options.backward) {
    return fail(ErrorCode::InvalidState, "nothing was kept for steps back; run with `backward`");
  }
  if (held_.empty()) return fail(ErrorCode::InvalidState, "the mission is not held");
  auto hierarchy = out_to_something_done(*held_.back());
  if (!hierarchy) return hierarchy.error();
  undo_at(**hierarchy);
  return {};
}

/// The hierarchy itself, or the nearest around it that has done something; those between are left backwards.
Result<Activation*> EngineCore::out_to_something_done(Activation& hierarchy) {
  Activation* child = nullptr;
  Activation* around = &hierarchy;
  while (around != nullptr && around->trail.empty()) {
    if (is_concurrency(program->node(around->state).kind)) {
      return fail(ErrorCode::NotFound, "what was before is outside of states that run side by side");
    }
    child = around;
    around = around->parent;
  }
  if (around == nullptr) return fail(ErrorCode::NotFound, "nothing has been done yet");
  held_.pop_back();
  hierarchy.held = false;
  if (child == nullptr) return around;
  around->pending = {Step::Kind::Child, program->node(child->state).position, 0};
  around->phase = Phase::Proceed;
  around->children.clear();
  for (Activation* inner = &hierarchy; inner != around;) {
    Activation* outer = inner->parent;
    if (inner->item != History::kNone) history.undo(inner->item);
    free(*inner);
    inner = outer;
  }
  return around;
}

/// Undoes the last action in a hierarchy that has done something, and holds before it.
void EngineCore::undo_at(Activation& hierarchy) {
  Activation* at = &hierarchy;
  while (true) {
    Trail trail = std::move(at->trail.back());
    at->trail.pop_back();
    restore(*at, trail);
    if (trail.kept == nullptr) {
      undo_leaf(*at, program->node(at->state).children[trail.position], trail);
      break;
    }
    Activation* inner = trail.kept;
    while (program->node(inner->state).kind == StateKind::Library)
      inner = inner->children.front();
    if (inner->trail.empty()) {
      undo_all(*trail.kept);
      forget(*trail.kept);
      break;
    }
    // Enters it again, at its end.
    at->children.assign(1, trail.kept);
    at->phase = Phase::Wait;
    at = inner;
  }
  hold(*at);
  mode_ = Mode::Hold;
}

void EngineCore::restore(Activation& hierarchy, Trail& trail) {
  for (auto replaced = trail.before.rbegin(); replaced != trail.before.rend(); ++replaced)
    hierarchy.slots[replaced->first] = std::move(replaced->second);
  hierarchy.last = trail.last;
  hierarchy.error = std::move(trail.error);
  hierarchy.pending = {Step::Kind::Child, trail.position, 0};
  hierarchy.phase = Phase::Proceed;
}

/// Calls the action backward and waits for its end.
void EngineCore::undo_leaf(Activation& around, StateIndex state, const Trail& done) {
  if (done.item != History::kNone) history.undo(done.item);
  if (done.refused) return;
  Activation& leaf = *make(state, &around);
  leaf.inputs = done.inputs;
  for (const Supply& output : program->node(state).outputs)
    leaf.outputs.push_back(fallback(output));
  backward_ = true;
  bool under_way = false;
  (void)call(leaf, under_way);
  backward_ = false;
  if (under_way) {
    leaf.phase = Phase::Wait;
    while (leaf.phase == Phase::Wait) {
      wait();
      read_news();
    }
    std::erase(ready_, &leaf);
  }
  free(leaf);
  world.undo(done.changed);
}

/// Every action within, the last first; of states side by side the last branch first.
void EngineCore::undo_all(Activation& kept) {
  struct Work {
    Activation* activation;
    const Trail* trail;
  };
  std::vector<Work> open = {{&kept, nullptr}};
  while (!open.empty()) {
    const Work work = open.back();
    open.pop_back();
    if (work.trail != nullptr && work.trail->kept == nullptr) {
      const StateIndex state = program->node(work.activation->state).children[work.trail->position];
      undo_leaf(*work.activation, state, *work.trail);
      continue;
    }
    Activation& inside = work.trail == nullptr ? *work.activation : *work.trail->kept;
    const StateKind kind = program->node(inside.state).kind;
    if (inside.item != History::kNone) history.undo(inside.item);
    if (kind == StateKind::Execution)
      undo_leaf(*inside.parent, inside.state,
                {0, inside.item, inside.inputs, inside.changed, inside.refused});
    if (kind == StateKind::Decider) world.undo(inside.changed);
    for (Activation* child : inside.children)
      open.push_back({child, nullptr});
    for (const Trail& trail : inside.trail)
      open.push_back({&inside, &trail});
  }
}

/// Gives a kept activation and all within back to the pool.
void EngineCore::forget(Activation& kept) {
  std::vector<Activation*> open = {&kept};
  while (!open.empty()) {
    Activation& activation = *open.back();
    open.pop_back();
    open.insert(open.end(), activation.children.begin(), activation.children.end());
    for (const Trail& trail : activation.trail) {
      if (trail.kept != nullptr) open.push_back(trail.kept);
    }
    free(activation);
  }
}

}  // namespace segue::mission::detail
