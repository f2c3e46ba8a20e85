// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/task_network/task_network.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace segue::pddl {

/// A text and the file name for messages.
struct PddlText {
  std::string_view text;
  std::string file;
};

enum class PddlPart { Domain, Problem, Plan };
/// The kind of a text; nothing, and diagnostics, where it cannot be parsed.
std::optional<PddlPart> part_of(const PddlText& text, Diagnostics& diagnostics);

/// A domain, a problem and a sequential or time-stamped plan, as planners write it, as a network: each step
/// is an irreversible node of 1 s that uses no resource; the goal is that of the problem. Supports STRIPS
/// with typing (including `either`), negative preconditions, equality, constants, conditional and `forall`
/// effects; numeric costs are ignored. Everything else that PDDL has (constraints, numeric conditions,
/// processes, ...) is refused by name. Steps are in the order of their times, of which and of durations
/// nothing else is kept. Names are case-insensitive. A conditional effect becomes the effect that it has at
/// its place in the plan, with the facts that decide it as preconditions. The plan is simulated step by step:
/// a precondition or a goal that does not hold is an error with its place. If there are errors, nothing is
/// returned.
std::optional<task_network::TaskNetwork> read_pddl(const PddlText& domain, const PddlText& problem,
                                                   const PddlText& plan, Diagnostics& diagnostics);
/// Reads a domain, a problem and a plan from files. Blocks.
std::optional<task_network::TaskNetwork> load_pddl(const std::filesystem::path& domain,
                                                   const std::filesystem::path& problem,
                                                   const std::filesystem::path& plan,
                                                   Diagnostics& diagnostics);

}  // namespace segue::pddl
