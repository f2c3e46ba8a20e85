// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/cdtn/task_network.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace segue::pddl {

/// A text and how messages call it.
struct PddlText {
  std::string_view text;
  std::string file;
};

/// A domain, a problem and a sequential plan as a network: each step is an irreversible node of 1 s that
/// needs no resource; its goal is the problem's. Understands STRIPS with typing (`either` too), negative
/// preconditions, equality, constants, conditional effects and `forall` effects of ground size, and numeric
/// costs, which it leaves out. Names do not tell upper from lower case. A conditional effect becomes what it
/// does where the plan puts it, with the facts that decide it as preconditions. The plan is carried out step
/// by step: a precondition or a goal that does not hold is an error with its place. Where there are errors,
/// nothing is returned.
std::optional<cdtn::TaskNetwork> read_pddl(const PddlText& domain, const PddlText& problem,
                                           const PddlText& plan, Diagnostics& diagnostics);
/// Likewise from files. Blocks.
std::optional<cdtn::TaskNetwork> load_pddl(const std::filesystem::path& domain,
                                           const std::filesystem::path& problem,
                                           const std::filesystem::path& plan, Diagnostics& diagnostics);

}  // namespace segue::pddl
