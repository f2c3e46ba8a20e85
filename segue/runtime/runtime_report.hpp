// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/runtime/controller_files.hpp>
#include <segue/runtime/robot_snapshot.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/task_host/task_host.hpp>
#include <segue/type/value.hpp>

/// Reports of the runtime as Values. Their fields are those of the JSON output, which tools may rely on.
namespace segue::runtime {

/// "done", "failed" or "skipped".
std::string_view outcome_of(const ActionRecord& record);

/// {"outcome", "cause", "request", "who", "time", "from", "to", "runs", "from_version", "to_version",
/// "runs_version", "order", "solve_s", "duration_s", "prepare_s", "commit_s", "retire_s", "actions", and
/// unless it succeeded "error", "diagnostics", "undo" ("restored", "fallback", "fell_back", "duration_s",
/// "actions", "error") and "leftover", with a prediction "predicted_s", and if it found tasks prepared
/// "ahead" ("tasks", "unprepared_s", "saved_s")}; each action with "started_s",
/// "duration_s" (until its end was reported), "took_s" (its execution, if measured), "outcome" (done, failed,
/// skipped).
type::Value to_value(const SwitchResult& result);

/// {"total", "prepare", "commit", "retire": {"low", "typical", "high"}, "actions": what each typically takes,
/// in the order of the transition, "critical_path": ids, "never_measured": a number of actions}, in seconds.
type::Value to_value(const solve::Estimate& estimate);

/// The fields of the transition, "changes": sentences, and where it is known "estimate_s" (as above).
type::Value to_value(const PlannedSwitch& planned);

/// {"controller", "change" (added, changed, removed), "runs", "file", "from_version", "to_version", "edits"}
type::Value to_value(const ControllerChange& change);

/// {"outcome", "changes", and if there was one "transition" (as above), "error", "diagnostics"}
type::Value to_value(const ApplyResult& result);

/// {"file", "change" (added, changed, removed)}
type::Value to_value(const FileChange& change);

/// A list of {"severity", "code", "message", "file", "line", "column"}
type::Value to_value(const Diagnostics& diagnostics);

/// {"pool", "size", "ready" (how many instances are), "instances" (a list of {"task", "ready", "pid",
/// "given_up", "reason", "busy"})}
type::Value to_value(const PoolReport& pool);
type::Value to_value(const UnresolvedFault& fault);

/// {"at_rest", "duration_s", "stopped", "trouble"}
type::Value to_value(const HaltResult& result);

/// {"controller", "ready", "prepared", "tasks", "reason"}
type::Value to_value(const Readiness& readiness);

/// {"state", "troubles"}, as of control::RobotService::status().
type::Value to_value(const Health& health);

type::Value to_value(const OpenRequest& request);
/// {"number", "time", "kind", "subject", "message", "trouble"}; the time in ISO 8601, UTC.
type::Value to_value(const Event& event);

/// {"id", "component", "state", "state_name", "host", "process", "pid", "stand_in", "cycle_us", "worst_us",
/// "latency_us", "cpu_us", "cycles", "missed", "error"}; cycle_us is the mean duration of an update, cpu_us
/// the processor time of all since the task started.
type::Value to_value(const task_host::TaskReport& report);

/// {"from", "to", "policy", "size", "written", "read", "dropped", "measured" (how many samples are in the
/// next two), "latency_us" (mean), "latency_worst_us"}
type::Value to_value(const task_host::ComputerReport& report);
type::Value to_value(const task_host::ConnectionReport& report);

/// {"robot", "controller", "version" (of what runs), "loaded_version" (of the controller of that name; null:
/// the robot has none), "state", "controllers", "ready" (a list as above), "pools", "tasks",
/// "connections", "differences"}: a robot at a glance.
type::Value status_of(Runtime& runtime);
/// Of that, what no process is asked for: "controller" and "unresolved"; and like that "in_repair".
type::Value running_of(const Runtime& runtime);

/// One task: the fields of its report, "ports", "properties", "operations", "timing", and unless its process
/// runs an older Segue "histograms" ("updates", "latencies", each with "p50_us", "p99_us" and "bins": a list
/// of "from_us", "below_us" (null: no end) and "count") and "log" (a list of "number", "time", "level",
/// "message"). NotFound if there is none.
Result<type::Value> task_report(Runtime& runtime, const model::TaskId& task);

}  // namespace segue::runtime
