// SPDX-License-Identifier: Apache-2.0
//
// What an engine writes into the journal of its run, and takes from that of a run that broke off.
#include <segue/mission/engine_core.hpp>

#include <algorithm>

namespace segue::mission::detail {

/// What an earlier run has ended comes first; what it has not begins only then.
Ending EngineCore::call_recorded(Activation& leaf, bool& under_way) {
  under_way = true;
  if (recall(leaf)) return {};
  if (recalled_count_ < options.journal->size()) {
    postponed_.emplace_back(&leaf, leaf.generation);
    return {};
  }
  return begin_recorded(leaf, under_way);
}

Ending EngineCore::begin_recorded(Activation& leaf, bool& under_way) {
  under_way = false;
  if (auto ending = settled(leaf)) return *std::move(ending);
  record_begin(leaf);
  return execute(leaf, under_way);
}

bool EngineCore::begin_postponed() {
  if (postponed_.empty()) return false;
  const auto [leaf, generation] = postponed_.front();
  postponed_.pop_front();
  if (leaf->generation != generation) return true;  // preempted meanwhile
  bool under_way = false;
  Ending ending = begin_recorded(*leaf, under_way);
  if (!under_way) complete(*leaf, std::move(ending));
  return true;
}

/// True where its end is known: it comes in its turn, as ends of what is under way do.
bool EngineCore::recall(Activation& leaf) {
  const auto place = options.journal->find(path(leaf), leaf.iteration);
  if (!place) return false;
  leaf.deferred = true;
  ++open_calls_;
  recalled_.emplace(*place, std::pair(&leaf, leaf.generation));
  return true;
}

/// Of an action that had begun and not ended when an earlier run broke off: how it is taken to have ended.
std::optional<Ending> EngineCore::settled(const Activation& leaf) const {
  const Action& action = program->mission().actions[program->node(leaf.state).action];
  switch (options.journal->interrupted(path(leaf), leaf.iteration)) {
    case RunJournal::UnderWay::Skip: {
      const auto& outcomes = action.outcomes;
      const auto expected = std::ranges::find(outcomes, action.foreseen_outcome());
      return Ending{expected == outcomes.end() ? 0 : static_cast<Outcome>(expected - outcomes.begin()), {}};
    }
    case RunJournal::UnderWay::Abort:
      return Ending{kAborted, "it had begun and not ended when the run broke off"};
    case RunJournal::UnderWay::Again:
    case RunJournal::UnderWay::Refuse:
      break;
  }
  return std::nullopt;
}

/// The next end of the earlier run, as soon as nothing else is to be done: so everything comes in the order
/// in which it came then. False where there is none.
bool EngineCore::recall_next() {
  if (recalled_.empty()) return false;
  const auto [place, waiting] = *recalled_.begin();
  recalled_.erase(recalled_.begin());
  const auto [leaf, generation] = waiting;
  ++recalled_count_;
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
  leaf->recalled = true;
  complete(*leaf, {end.outcome, end.error});
  return true;
}

void EngineCore::record_begin(const Activation& leaf) {
  const Action& action = program->mission().actions[program->node(leaf.state).action];
  const bool decides = std::holds_alternative<Decision>(action.run);
  options.journal->began(path(leaf), leaf.iteration, !action.pure && !action.sensing && !decides);
}

void EngineCore::record_end(const Activation& leaf) {
  options.journal->ended(path(leaf), leaf.iteration,
                         {leaf.outcome, leaf.error, leaf.preempted, leaf.outputs, {}, {}},
                         globals.snapshot());
}

}  // namespace segue::mission::detail
