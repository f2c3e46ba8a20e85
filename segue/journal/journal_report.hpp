// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/journal/entries.hpp>
#include <segue/type/value.hpp>

/// Converts entries to Values. Their fields are those of the JSON output, which tools may rely on.
namespace segue::journal {

/// {"low", "typical", "high"} in seconds.
type::Value to_value(const model::DurationRange& range);
/// {"total", "commit"}
type::Value to_value(const Prediction& prediction);
/// {"tasks", "unprepared_s", "saved_s"} of a transition whose prepare phase took `prepare`.
type::Value to_value(const PreparedAhead& ahead, Duration prepare);
/// The fields of the JSON of `switch`, "time" (ISO 8601, UTC) and, if there was one, "predicted_s".
type::Value to_value(const TransitionEntry& entry);
/// {"time", "subject", "sentence", "done"}
type::Value to_value(const DifferenceEntry& entry);
/// {"time", "controller", "version", "file", "text"}
type::Value to_value(const VersionEntry& entry);
/// {"time", "kind" ("began", "asked", "ended"), "who", "mission"}; of an action also "action" and
/// "iteration", and where it asked "controller"; where it ended "outcome", "duration_s" and, if it aborted,
/// "error".
type::Value to_value(const MissionEntry& entry);
/// {"time", "lost", "reason"}
type::Value to_value(const GapEntry& entry);

}  // namespace segue::journal
