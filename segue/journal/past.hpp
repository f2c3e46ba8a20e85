// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <filesystem>

namespace segue::journal {

/// Answers a question about the past of a robot from its journal, also while the robot writes it. Answers are
/// bounded, however large the journal is. `question` is a map with the word "ask"; times are seconds since
/// 1970, exact to a microsecond.
///
/// "requests": the newest requests, newest first, {"before": only those older than that id; "limit": 100 at
/// most; "words": all of these must be in its names, outcome or error}. Answers {"requests": [{"id",
/// "request", "ended_s", "lasted_s" (null: not recorded), "cause", "who", "cancelled_by", "from", "to",
/// "outcome", "undone", "error", "actions" (their number)}], "more": there are older ones}.
///
/// "request": one, {"id"}. Answers its JSON of `history` and {"id", "ended_s", "lasted_s", "undo_actions",
/// "before", "after": networks, as JSON text; null: not recorded}.
///
/// "missions": the newest runs of missions, newest first, {"before": only those older than that id; "limit":
/// 100 at most}. Answers {"missions": [{"id", "mission", "who", "mode" ("sequential", "concurrent"; "": not
/// recorded), "began_s", "ended_s" (null: not recorded, as while it runs), "outcome", "error"}], "more":
/// there are older ones}.
///
/// "mission": one run, {"id"}. Answers the same and {"entries" (as of control::RobotService::mission(), the
/// newest 4000), "dropped": entries before those}.
///
/// "at": the robot at a time, {"time_s"}. Answers {"time_s", "known", "since_s" (the entry that says what
/// ran), "controller", "version", "network" (JSON text; null: not known), "transition" (the id of the one
/// that was in progress; null: none), "missions": [{"mission", "who", "actions": those that ran}],
/// "differences": found since then, "notes": sentences about what is not known}.
///
/// "span": of what is recorded. Answers {"first_s", "last_s" (null: nothing), "marks": [{"id", "time_s",
/// "outcome"}], 500 at most, evenly chosen}.
///
/// "clock": the clock that the times of a journal are of. Answers {"now_s"}, without the file.
///
/// NotFound where there is no journal, or no such request or run; InvalidArgument where the question is none.
/// Blocks while the file is read.
Result<type::Value> answer_about_past(const std::filesystem::path& path, const type::Value& question);

}  // namespace segue::journal
