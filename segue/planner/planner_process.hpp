// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>

#include <cstdint>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

namespace segue::planner {

/// A planner that is a program of its own.
struct PlannerCommand {
  /// The program and its arguments. "{domain}" and "{problem}" in them stand for files; "{plan}" for the file
  /// into which it writes the plan, or "{plan}.1", "{plan}.2" and so on, of which the last counts. Without
  /// "{plan}", what it prints is the plan.
  std::vector<std::string> words;
  Duration timeout = std::chrono::seconds(60);
  std::uint64_t memory = 0;  ///< bytes of address space for each of its processes; 0: no limit
};

/// Runs the planner in a folder and a process group of its own, both of which are gone afterwards, and
/// returns the text of its plan, of which only the reader of plans knows whether it is one. Blocks. Errors:
/// NotFound where it cannot be started or ends without a plan; DeadlineExceeded after the timeout; Cancelled;
/// IoError where a signal ends it; ResourceExhausted where it writes more than 64 MB into one file. Their
/// messages have the last line that it has written.
Result<std::string> run_planner(const PlannerCommand& command, std::string_view domain,
                                std::string_view problem, const std::stop_token& stop);

}  // namespace segue::planner
