// SPDX-License-Identifier: Apache-2.0
//
// Recording a run in its journal, and replaying the journal of an interrupted run.
#include <segue/mission_engine/engine_core.hpp>
#include <segue/mission_robot/fact_observer.hpp>

namespace segue::mission::detail {

/// Ends that the journal has are replayed first; actions that it lacks begin only after that.
Ending EngineCore::call_with_journal(Activation& leaf, bool& under_way) {
  under_way = true;
  if (replay_end(leaf)) return {};
  if (replayed_count_ < options.journal->size()) {
    postponed_.emplace_back(&leaf, leaf.generation);
    return {};
  }
  return begin_with_journal(leaf, under_way);
}

Ending EngineCore::begin_with_journal(Activation& leaf, bool& under_way) {
  under_way = false;
  const Action& action = program->mission().actions[program->node(leaf.state).action];
  if (auto end = options.journal->assumed_end({path(leaf), leaf.iteration}, action))
    return {end->outcome, std::move(end->error)};
  record_begin(leaf);
  return execute(leaf, under_way);
}

bool EngineCore::begin_postponed() {
  if (postponed_.empty()) return false;
  const auto [leaf, generation] = postponed_.front();
  postponed_.pop_front();
  if (leaf->generation != generation) return true;  // it was preempted meanwhile
  fill_world_inputs(*leaf);                         // what was replayed meanwhile may have changed it
  bool under_way = false;
  const Ending ending = begin_with_journal(*leaf, under_way);
  if (!under_way) complete(*leaf, ending);
  return true;
}

/// True if the journal has the end of this execution: replay_next() will deliver it in its turn.
bool EngineCore::replay_end(Activation& leaf) {
  const auto place = options.journal->find({path(leaf), leaf.iteration});
  if (!place) return false;
  leaf.deferred = true;
  ++open_calls_;
  replaying_.emplace(*place, std::pair(&leaf, leaf.generation));
  return true;
}

/// Delivers the next end of the earlier run. Called only when nothing else can go on, so that all ends come
/// in their original order. False if there is none.
bool EngineCore::replay_next() {
  if (replaying_.empty()) return false;
  const auto [place, waiting] = *replaying_.begin();
  replaying_.erase(replaying_.begin());
  const auto [leaf, generation] = waiting;
  ++replayed_count_;
  if (leaf->generation != generation) return true;
  const RunJournal::End& end = (*options.journal)[place];
  if (end.outputs.size() == leaf->outputs.size()) leaf->outputs = end.outputs;
  for (const auto& [name, value] : end.globals) {
    if (const auto set = globals.set(name, value); !set) warn(*leaf, set.error().message);
  }
  for (const std::string& name : end.erased) {
    if (const auto erased = globals.erase(name); !erased) warn(*leaf, erased.error().message);
  }
  leaf->preempted = end.preempted;
  leaf->replayed = true;
  const Action& action = program->mission().actions[program->node(leaf->state).action];
  if (observer && leaf->observed &&
      program->outcome_name(leaf->state, end.outcome) == action.foreseen_outcome())
    observer->assume(leaf->observed->effects);
  complete(*leaf, {end.outcome, end.error});
  return true;
}

void EngineCore::record_begin(const Activation& leaf) {
  const Action& action = program->mission().actions[program->node(leaf.state).action];
  options.journal->began({path(leaf), leaf.iteration}, action.action_class() == ActionClass::Irreversible,
                         action.name.str());
}

void EngineCore::record_end(const Activation& leaf) {
  options.journal->ended({path(leaf), leaf.iteration},
                         {leaf.outcome, leaf.error, leaf.preempted, leaf.outputs, {}, {}},
                         globals.snapshot());
}

}  // namespace segue::mission::detail
