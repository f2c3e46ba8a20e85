// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/all_changes.hpp>
#include <segue/convert/conversion_fault.hpp>
#include <segue/convert/reporter.hpp>

#include <memory>

namespace segue::convert {

using mission::Ending;
using mission::kAborted;
using mission::kPreempted;
using mission::Outcome;
using task_network::ReportPtr;
using type::Value;
using type::ValueMap;

namespace {

/// The effect in a text such as "p(a)" or "!p(a)".
task_network::NamedEffect named_effect(const std::string& text) {
  const bool value = !text.starts_with('!');
  return {text.substr(value ? 0 : 1), value};
}

}  // namespace

ReportPtr ActionEnvironment::Reporter::report(const Ending& ending, std::vector<Value> outputs,
                                              const SubtreeChanges& changes) {
  Outcome outcome = ending.outcome;
  std::string error = ending.error;
  if (cancelled && !planted(ConversionFault::CountsCancelled)) {
    outcome = kPreempted;
  } else if (outcome < kPreempted || outcome >= static_cast<Outcome>(outcomes.size())) {
    outcome = planted(ConversionFault::AcceptsAnyOutcome) ? 0 : kAborted;
    error = "its action ended with an outcome that it does not declare";
  }
  auto report = std::make_unique<task_network::Report>();
  report->outcome = outcome == kAborted     ? task_network::kAborted
                    : outcome == kPreempted ? task_network::kPreempted
                                            : outcomes[static_cast<std::size_t>(outcome)];
  report->error = error;
  ValueMap map;
  for (std::size_t i = 0; i < ports.size() && i < outputs.size(); ++i) {
    const bool is_error = ports[i] == "error" && !error.empty();
    map.append(ports[i], is_error ? Value(error) : std::move(outputs[i]));
  }
  map.append(std::string(kOutcomeOutput), static_cast<std::uint64_t>(report->outcome));
  if (outcome != kPreempted && !error.empty())
    map.append(std::string(outcome == kAborted ? kErrorOutput : kHandledErrorOutput), error);
  if (passes_on == PassedOn::Count)
    map.append(std::string(kCountOutput), passed_on + (planted(ConversionFault::CountsTwice) ? 2 : 1));
  const bool forgets = ending.memory == 0 || planted(ConversionFault::ForgetsMemory);
  if (passes_on == PassedOn::Memory)
    map.append(std::string(kMemoryOutput), forgets ? passed_on : ending.memory);
  for (const auto& [name, value] : changes.values)
    map.append("world." + name, value);
  for (const std::string& fact : changes.facts)
    report->named_effects.push_back(named_effect(fact));
  for (const auto& [resource, change] : changes.units)
    report->named_units.push_back({resource, change});
  if (recorded) map.append(std::string(kRecordOutput), NodeJournal::record_of(globals, changes));
  report->outputs = std::make_shared<const Value>(std::move(map));
  report->pending = std::make_unique<AllChanges>(globals.pending_changes(), ending.pending);
  return report;
}

}  // namespace segue::convert
