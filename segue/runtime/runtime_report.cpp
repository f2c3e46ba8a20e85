// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/runtime_report.hpp>

#include <segue/base/clock.hpp>
#include <segue/base/text.hpp>
#include <segue/journal/journal_report.hpp>
#include <segue/model/files.hpp>
#include <segue/runtime/served_runtime.hpp>

#include <algorithm>

namespace segue::runtime {

namespace {

using type::Value;
using type::ValueMap;

double seconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

double microseconds(Duration duration) {
  return std::chrono::duration<double, std::micro>(duration).count();
}

Value action_value(const ActionRecord& record) {
  Value value = model::to_value(record.action);
  if (!value.is_map()) {
    value = ValueMap{};
  }
  ValueMap& map = value.as_map();
  map.set("started_s", seconds(record.started));
  map.set("duration_s", seconds(record.duration));
  if (record.took) {
    map.set("took_s", seconds(*record.took));
  }
  map.set("outcome", outcome_of(record));
  if (record.error) {
    map.set("error", to_string(*record.error));
  }
  return value;
}

Value diagnostic_value(const Diagnostic& diagnostic) {
  return Value::map({{"severity", to_string(diagnostic.severity)},
                     {"code", diagnostic.code},
                     {"message", diagnostic.message},
                     {"file", diagnostic.where.file},
                     {"line", diagnostic.where.line},
                     {"column", diagnostic.where.column}});
}

template <class Items, class Convert>
Value list_of(const Items& items, Convert convert) {
  Value::List list;
  list.reserve(items.size());
  for (const auto& item : items) {
    list.push_back(convert(item));
  }
  return list;
}

Value timing_value(const task::Timing& timing) {
  return Value::map({{"cycles", timing.cycles},
                     {"missed", timing.missed},
                     {"last_us", microseconds(timing.last)},
                     {"mean_us", microseconds(timing.mean)},
                     {"worst_us", microseconds(timing.worst)},
                     {"latency_mean_us", microseconds(timing.latency_mean)},
                     {"latency_worst_us", microseconds(timing.latency_worst)},
                     {"jitter_us", microseconds(timing.jitter)},
                     {"cpu_us", microseconds(timing.cpu)}});
}

/// The bins from the first to the last that has any. Quantiles are ends of bins, so the worst may be less.
Value histogram_value(const task::DurationHistogram& histogram, Duration worst) {
  using Histogram = task::DurationHistogram;
  std::size_t begin = 0;
  std::size_t end = Histogram::kBins;
  while (begin < end && histogram.counts[begin] == 0)
    ++begin;
  while (end > begin && histogram.counts[end - 1] == 0)
    --end;
  Value::List bins;
  for (std::size_t bin = begin; bin < end; ++bin) {
    const bool is_last = bin + 1 == Histogram::kBins;
    bins.push_back(Value::map({{"from_us", microseconds(Histogram::from(bin))},
                               {"below_us", is_last ? Value() : Value(microseconds(Histogram::below(bin)))},
                               {"count", histogram.counts[bin]}}));
  }
  const auto quantile = [&](double share) {
    return microseconds(std::min(histogram.quantile(share), worst));
  };
  return Value::map({{"p50_us", quantile(0.5)}, {"p99_us", quantile(0.99)}, {"bins", std::move(bins)}});
}

Value histograms_value(const task_host::TaskDetails& details, const task::Timing& timing) {
  return Value::map({{"updates", histogram_value(details.timing.updates, timing.worst)},
                     {"latencies", histogram_value(details.timing.latencies, timing.latency_worst)}});
}

Value line_value(const LogLine& line) {
  return Value::map({{"number", line.number},
                     {"time", iso_time(line.time)},
                     {"level", to_string(line.level)},
                     {"message", line.message}});
}

Value port_value(const model::PortModel& port) {
  return Value::map({{"name", port.name},
                     {"direction", model::to_string(port.direction)},
                     {"type", port.type},
                     {"dynamic", port.dynamic},
                     {"pattern", port.pattern},
                     {"doc", port.doc}});
}

Value property_value(const model::PropertyModel& property) {
  return Value::map({{"name", property.name},
                     {"type", property.type},
                     {"default", property.default_value},
                     {"live", property.live},
                     {"doc", property.doc}});
}

Value operation_value(const model::OperationModel& operation) {
  return Value::map(
      {{"name", operation.name},
       {"arguments",
        list_of(
            operation.arguments,
            [](const model::ArgumentModel& argument) {
              return Value::map({{"name", argument.name}, {"type", argument.type}, {"doc", argument.doc}});
            })},
       {"result", operation.result},
       {"doc", operation.doc}});
}

Value undo_value(const Undo& undo) {
  Value value = Value::map({{"restored", undo.restored},
                            {"duration_s", seconds(undo.duration)},
                            {"actions", list_of(undo.actions, action_value)}});
  if (undo.fallback) {
    value.as_map().set("fallback", undo.fallback->str());
    value.as_map().set("fell_back", undo.fell_back);
  }
  if (undo.error) {
    value.as_map().set("error", to_string(*undo.error));
  }
  return value;
}

}  // namespace

std::string_view outcome_of(const ActionRecord& record) {
  if (!record.executed) {
    return "skipped";
  }
  return record.error ? "failed" : "done";
}

namespace {

void set_error(Value& value, const std::optional<Error>& error) {
  if (!error) {
    return;
  }
  value.as_map().set("error", to_string(*error));
  if (error->diagnostics != nullptr) {
    value.as_map().set("diagnostics", to_value(*error->diagnostics));
  }
}

}  // namespace

Value to_value(const SwitchResult& result) {
  Value value = Value::map({{"outcome", to_string(result.outcome)},
                            {"cause", to_string(result.cause)},
                            {"request", result.request},
                            {"who", result.who},
                            {"time", iso_time(result.time)},
                            {"from", result.from.str()},
                            {"to", result.to.str()},
                            {"runs", result.runs.str()},
                            {"from_version", result.from_version},
                            {"to_version", result.to_version},
                            {"runs_version", result.runs_version},
                            {"order", model::to_string(result.order)},
                            {"solve_s", seconds(result.solve_time)},
                            {"duration_s", seconds(result.duration)},
                            {"prepare_s", seconds(result.prepare)},
                            {"commit_s", seconds(result.commit)},
                            {"retire_s", seconds(result.retire)},
                            {"actions", list_of(result.actions, action_value)}});
  set_error(value, result.error);
  if (!result.cancelled_by.empty()) {
    value.as_map().set("cancelled_by", result.cancelled_by);
  }
  if (result.predicted) {
    value.as_map().set("predicted_s", journal::to_value(*result.predicted));
  }
  if (result.ahead) {
    value.as_map().set("ahead", journal::to_value(*result.ahead, result.prepare));
  }
  if (result.undo) {
    value.as_map().set("undo", undo_value(*result.undo));
  }
  if (result.leftover) {
    value.as_map().set("leftover", to_string(*result.leftover));
  }
  return value;
}

Value to_value(const solve::Estimate& estimate) {
  Value value = Value::map({{"total", journal::to_value(estimate.total)}});
  for (const auto phase : {model::Phase::Prepare, model::Phase::Commit, model::Phase::Retire}) {
    value.as_map().set(std::string(to_string(phase)), journal::to_value(estimate.of(phase)));
  }
  value.as_map().set("actions",
                     list_of(estimate.typical, [](Duration typical) { return Value(seconds(typical)); }));
  value.as_map().set("critical_path", list_of(estimate.critical_path, [](int id) { return Value(id); }));
  value.as_map().set("never_measured", estimate.never_measured);
  return value;
}

Value to_value(const PlannedSwitch& planned) {
  Value value = model::to_value(planned.transition);
  value.as_map().set("changes",
                     list_of(planned.changes, [](const std::string& text) { return Value(text); }));
  if (planned.expected) {
    value.as_map().set("estimate_s", to_value(*planned.expected));
  }
  return value;
}

Value to_value(const ControllerChange& change) {
  return Value::map({{"controller", change.controller.str()},
                     {"change", to_string(change.kind)},
                     {"runs", change.runs},
                     {"file", change.file},
                     {"from_version", change.from_version},
                     {"to_version", change.to_version},
                     {"edits", list_of(change.edits, [](const std::string& text) { return Value(text); })}});
}

Value to_value(const ApplyResult& result) {
  Value value = Value::map({{"outcome", to_string(result.outcome)},
                            {"changes", list_of(result.changes, [](const ControllerChange& change) {
                               return to_value(change);
                             })}});
  if (result.transition) {
    value.as_map().set("transition", to_value(*result.transition));
  }
  set_error(value, result.error);
  return value;
}

Value to_value(const FileChange& change) {
  return Value::map({{"file", change.path.string()}, {"change", to_string(change.kind)}});
}

Value to_value(const Diagnostics& diagnostics) {
  return list_of(diagnostics.items(), diagnostic_value);
}

Value to_value(const Readiness& readiness) {
  return Value::map({{"controller", readiness.controller.str()},
                     {"ready", readiness.ready},
                     {"prepared", static_cast<std::uint64_t>(readiness.prepared)},
                     {"tasks", static_cast<std::uint64_t>(readiness.tasks)},
                     {"reason", readiness.reason}});
}

Value to_value(const OpenRequest& request) {
  return Value::map({{"request", request.request},
                     {"to", request.to.str()},
                     {"who", request.who},
                     {"state", request.state},
                     {"cancelled_by", request.cancelled_by.empty() ? Value() : Value(request.cancelled_by)}});
}

Value to_value(const Event& event) {
  return Value::map({{"number", event.number},
                     {"time", iso_time(event.time)},
                     {"kind", to_string(event.kind)},
                     {"subject", event.subject},
                     {"message", event.message},
                     {"trouble", event.trouble}});
}

Value to_value(const task_host::TaskReport& report) {
  return Value::map({{"id", report.id.str()},
                     {"component", report.component.str()},
                     {"state", to_string(report.state)},
                     {"state_name", report.state_name},
                     {"host", report.process.host.str()},
                     {"process", report.process.process.str()},
                     {"pid", report.pid},
                     {"stand_in", report.stand_in},
                     {"cycle_us", microseconds(report.timing.mean)},
                     {"worst_us", microseconds(report.timing.worst)},
                     {"latency_us", microseconds(report.timing.latency_mean)},
                     {"cpu_us", microseconds(report.timing.cpu)},
                     {"cycles", report.timing.cycles},
                     {"missed", report.timing.missed},
                     {"unknown", report.unknown},
                     {"error", report.error}});
}

Value to_value(const task_host::ComputerReport& report) {
  const auto optional_us = [](const std::optional<Duration>& duration) {
    return duration ? Value(microseconds(*duration)) : Value();
  };
  return Value::map({{"name", report.name.str()},
                     {"address", report.address},
                     {"reachable", report.reachable},
                     {"optional", report.optional},
                     {"state", report.state},
                     {"since_s", seconds(report.since)},
                     {"software", report.software},
                     {"round_trip_us", optional_us(report.round_trip)},
                     {"clock_offset_us", optional_us(report.clock_offset)}});
}

Value to_value(const task_host::ConnectionReport& report) {
  return Value::map({{"from", to_string(report.connection.from)},
                     {"to", to_string(report.connection.to)},
                     {"policy", to_string(report.connection.policy.kind)},
                     {"size", static_cast<std::uint64_t>(report.connection.policy.size)},
                     {"written", report.written},
                     {"read", report.read},
                     {"dropped", report.dropped},
                     {"measured", report.latency.measured},
                     {"latency_us", microseconds(report.latency.mean)},
                     {"latency_p99_us", microseconds(report.latency.p99)},
                     {"latency_worst_us", microseconds(report.latency.worst)}});
}

Value to_value(const PoolReport& pool) {
  const auto ready = std::ranges::count_if(pool.instances, &PoolInstance::ready);
  return Value::map({{"pool", pool.pool},
                     {"size", static_cast<std::int64_t>(pool.instances.size())},
                     {"least", pool.least},
                     {"most", pool.most},
                     {"ready", static_cast<std::int64_t>(ready)},
                     {"waiting", pool.waiting},
                     {"held_back", pool.held_back},
                     {"instances", list_of(pool.instances, [](const PoolInstance& one) {
                        return Value::map({{"task", one.task.str()},
                                           {"ready", one.ready},
                                           {"pid", one.pid},
                                           {"given_up", one.given_up},
                                           {"reason", one.reason},
                                           {"busy", one.busy}});
                      })}});
}

Value to_value(const Health& health) {
  const auto now = std::chrono::system_clock::now();
  const auto trouble_value = [&](const Trouble& trouble) {
    return Value::map({{"kind", kTroubleKindNames.at(static_cast<std::size_t>(trouble.kind))},
                       {"name", trouble.name},
                       {"what", trouble.what},
                       {"why", trouble.why},
                       {"since", iso_time(trouble.since)},
                       {"for_s", std::chrono::duration<double>(now - trouble.since).count()},
                       {"repair", trouble.repair},
                       {"on_request", trouble.on_request}});
  };
  return Value::map({{"state", kHealthNames.at(static_cast<std::size_t>(health.state))},
                     {"troubles", list_of(health.troubles, trouble_value)}});
}

Value to_value(const UnresolvedFault& fault) {
  return Value::map(
      {{"fault", fault.sentence},
       {"controllers",
        list_of(fault.controllers, [](const model::NetworkName& name) { return Value(name.str()); })},
       {"task", fault.task ? Value(fault.task->str()) : Value()}});
}

Value to_value(const HaltResult& result) {
  return Value::map({{"at_rest", result.at_rest},
                     {"duration_s", seconds(result.duration)},
                     {"stopped", list_of(result.stopped, [](const auto& task) { return Value(task.str()); })},
                     {"trouble", result.trouble}});
}

namespace {

Value halt_value(const std::optional<Halted>& halted) {
  if (!halted) {
    return {};
  }
  Value value = halted->result ? to_value(*halted->result) : Value(ValueMap{});
  ValueMap& map = value.as_map();
  map.set("who", halted->request.who);
  map.set("why", halted->request.why);
  map.set("time_s", std::chrono::duration<double>(halted->time.time_since_epoch()).count());
  map.erase("at_rest");
  map.set("state", !halted->result ? "halting" : halted->result->at_rest ? "at_rest" : "not_at_rest");
  return value;
}

std::vector<task_host::ConnectionReport> existing(std::vector<task_host::ConnectionReport> reports) {
  std::erase_if(reports, [](const auto& report) { return !report.error.empty(); });
  return reports;
}

}  // namespace

Value status_of(Runtime& runtime) {
  const auto controller = runtime.belief().name;
  const auto loaded = runtime.controller(controller);
  const auto& served = runtime.served();
  const auto holder = served.lease_holder();
  const auto halted = runtime.halted();
  const auto lost = runtime.host().loss();
  const RobotSnapshot now = runtime.snapshot();
  return Value::map(
      {{"robot", runtime.name()},
       {"controller", controller.str()},
       {"version", runtime.version()},
       {"loaded_version", loaded ? Value(loaded->version) : Value()},
       {"state", to_string(runtime.state())},
       {"health", to_value(now.health)},
       {"commanded_by", holder ? Value(*holder) : Value()},
       {"doing", served.reported()},
       {"lost", lost ? Value(to_string(*lost)) : Value()},
       {"halt", halt_value(halted)},
       {"stopped_by", halted && !halted->stopped_by.empty() ? Value(halted->stopped_by) : Value()},
       {"requests", list_of(runtime.open_requests(), [](const OpenRequest& one) { return to_value(one); })},
       {"controllers",
        list_of(runtime.controllers(), [](const model::NetworkName& name) { return Value(name.str()); })},
       {"transitions", list_of(runtime.transitions(), [](const std::string& name) { return Value(name); })},
       {"ready", list_of(runtime.readiness(), [](const Readiness& one) { return to_value(one); })},
       {"pools", list_of(now.pools, [](const PoolReport& pool) { return to_value(pool); })},
       {"hosts", list_of(now.computers, [](const auto& report) { return to_value(report); })},
       {"tasks", list_of(now.seen.tasks, [](const auto& report) { return to_value(report); })},
       {"connections",
        list_of(existing(now.seen.connections), [](const auto& report) { return to_value(report); })},
       {"differences", list_of(now.differences, [](const std::string& text) { return Value(text); })},
       {"ended",
        list_of(served.ended_processes(),
                [](const auto& entry) {
                  return Value::map({{"process", to_string(entry.first)}, {"message", entry.second}});
                })},
       {"unresolved",
        list_of(runtime.unresolved(), [](const UnresolvedFault& fault) { return to_value(fault); })}});
}

Value running_of(const Runtime& runtime) {
  const auto value_of = [](const UnresolvedFault& fault) { return to_value(fault); };
  return Value::map({{"controller", runtime.belief().name.str()},
                     {"unresolved", list_of(runtime.unresolved(), value_of)},
                     {"in_repair", list_of(runtime.in_repair(), value_of)}});
}

Result<Value> task_report(Runtime& runtime, const model::TaskId& task) {
  const auto reports = runtime.host().tasks();
  const auto report =
      std::find_if(reports.begin(), reports.end(), [&](const auto& item) { return item.id == task; });
  if (report == reports.end()) {
    std::vector<std::string> names;
    for (const auto& item : reports) {
      names.push_back(item.id.str());
    }
    return fail(ErrorCode::NotFound,
                "no task " + quote(task.str()) + " runs" + did_you_mean(task.str(), names));
  }
  auto model = runtime.host().describe(task);
  if (!model) {
    return std::move(model.error());
  }
  auto properties = runtime.host().properties(task);
  if (!properties) {
    return std::move(properties.error());
  }
  const auto details = runtime.host().details(task);
  if (!details && details.error().code != ErrorCode::Unsupported) {
    return details.error();
  }
  Value value = to_value(*report);
  ValueMap& map = value.as_map();
  map.set("doc", model->doc);
  map.set("ports", list_of(model->ports, port_value));
  map.set("properties", std::move(*properties));
  map.set("property_models", list_of(model->properties, property_value));
  map.set("operations", list_of(model->operations, operation_value));
  map.set("timing", timing_value(report->timing));
  if (details) {  // else its process runs an older segue
    map.set("histograms", histograms_value(*details, report->timing));
    map.set("log", list_of(details->log, line_value));
  }
  return value;
}

}  // namespace segue::runtime
