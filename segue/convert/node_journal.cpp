// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/conversion_fault.hpp>
#include <segue/convert/node_journal.hpp>

#include <string>
#include <utility>

namespace segue::convert {

using mission::RunJournal;
using task_network::NodeId;
using task_network::OutcomeId;
using type::Value;

namespace {

std::vector<std::string> texts_of(const Value& list) {
  std::vector<std::string> texts;
  for (const Value& text : list.as_list())
    texts.push_back(text.as_string());
  return texts;
}

Value list_of(const std::vector<std::string>& texts) {
  return Value::List(texts.begin(), texts.end());
}

RunJournal::End end_of(const mission::CompiledState& state, const Value& outputs) {
  RunJournal::End end;
  for (const mission::Port& port : *state.output_ports) {
    const Value* value = outputs.find(port.name);
    end.outputs.push_back(value == nullptr ? Value() : *value);
  }
  for (const std::string_view name : {kErrorOutput, kHandledErrorOutput}) {
    if (const Value* error = outputs.find(name)) end.error = error->as_string();
  }
  const Value* record = outputs.find(kRecordOutput);
  if (record != nullptr && !planted(ConversionFault::ForgetsRecord)) {
    end.globals = record->find("globals")->as_map();
    end.erased = texts_of(*record->find("erased"));
    end.facts = texts_of(*record->find("facts"));
    end.units = mission::unit_changes(record->find("units")->as_map());
    end.begun = mission::counts_by_state(record->find("states")->as_map());
    end.values = record->find("values")->as_map();
  }
  return end;
}

}  // namespace

Value NodeJournal::record_of(const mission::Globals& used, const SubtreeChanges& changes) {
  auto variables = used.changes();
  return Value::map({{"globals", std::move(variables.set)},
                     {"erased", list_of(variables.erased)},
                     {"facts", list_of(changes.facts)},
                     {"units", mission::to_value(changes.units)},
                     {"states", mission::to_value(changes.begun)},
                     {"values", changes.values}});
}

bool NodeJournal::records(NodeId node) const {
  return !plan_.network()[node].structural;
}

mission::Execution NodeJournal::execution(NodeId node) const {
  if (planted(ConversionFault::ForgetsLoops)) return {std::string(plan_[node].path)};
  return {std::string(plan_[node].path), 0, plan_[node].loops};
}

NodeJournal::NodeJournal(const MissionPlan& plan, std::shared_ptr<RunJournal> journal)
    : plan_(plan), journal_(std::move(journal)), awaited_(journal_->executions()) {}

std::optional<RunJournal::End> NodeJournal::replayed(NodeId node) {
  if (!records(node) || planted(ConversionFault::ResumesNothing)) return std::nullopt;
  awaited_.erase(execution(node));
  if (const auto place = journal_->find(execution(node))) return (*journal_)[*place];
  static const mission::Action kSubtree;  // of which nothing is foreseen but its first outcome
  const mission::Program& program = plan_.program();
  const mission::StateIndex state = plan_[node].state;
  const bool is_action = plan_[node].role == Role::Action;
  return journal_->assumed_end(execution(node),
                               is_action ? program.mission().actions[program.node(state).action] : kSubtree);
}

bool NodeJournal::had_begun(NodeId node) const {
  if (!records(node)) return !awaited_.empty();
  return journal_->find(execution(node)) || !journal_->progress(execution(node)).is_null();
}

void NodeJournal::refused(NodeId node) {
  if (records(node)) awaited_.erase(execution(node));
}

void NodeJournal::began(NodeId node) {
  if (records(node) && plan_.network()[node].kind == ActionClass::Irreversible)
    journal_->began(execution(node), true, name_of_action(node));
}

std::string NodeJournal::name_of_action(NodeId node) const {
  if (plan_[node].role != Role::Action) return {};
  const mission::Program& program = plan_.program();
  return program.mission().actions[program.node(plan_[node].state).action].name.str();
}

std::function<void(const Value&)> NodeJournal::recorder(NodeId node) const {
  return [journal = journal_, of = execution(node)](const Value& progress) {
    journal->progressed(of, progress);
  };
}

void NodeJournal::ended(NodeId node, OutcomeId outcome, const Value* outputs) {
  if (!records(node) || journal_->find(execution(node))) return;
  static const Value kNone{type::ValueMap()};
  auto end = end_of(plan_.program().node(plan_[node].state), outputs == nullptr ? kNone : *outputs);
  end.outcome = plan_.outcome(node, outcome);
  journal_->ended(execution(node), end);
}

RaceRecord NodeJournal::races() const {
  RaceRecord record;
  record.firsts = journal_->firsts();
  record.awaits = [this](const mission::Execution& state) { return awaits(state); };
  const auto ended = [this](NodeId node, bool preempted) {
    const auto place = records(node) ? journal_->find(execution(node)) : std::nullopt;
    return place && ((*journal_)[*place].outcome == mission::kPreempted) == preempted;
  };
  record.replays = [ended](NodeId node) { return ended(node, false); };
  record.was_preempted = [ended](NodeId node) { return ended(node, true); };
  record.decided = [this](const mission::Execution& first) { journal_->first(first); };
  return record;
}

/// Paths and loops of what is in the state begin with those of the state.
bool NodeJournal::awaits(const mission::Execution& state) const {
  const auto within = [](const std::string& text, const std::string& around, char separator) {
    return around.empty() || text == around || text.starts_with(around + separator);
  };
  for (auto at = awaited_.lower_bound({state.path}); at != awaited_.end(); ++at) {
    if (!at->path.starts_with(state.path)) return false;
    if (within(at->path, state.path, '/') && within(at->loops, state.loops, '.')) return true;
  }
  return false;
}

void NodeJournal::finished(const std::string& outcome) {
  journal_->finished(outcome);
}

}  // namespace segue::convert
