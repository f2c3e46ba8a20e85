// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/program.hpp>

#include "mission_network.hpp"
#include "mission_run.hpp"

namespace segue::cli {

/// Its inputs as --input gives them, by port; null: the default. NotFound, InvalidArgument, TypeMismatch.
Result<std::vector<type::Value>> inputs_of(const mission::Program& program, const MissionOptions& options);

/// Runs a mission as a task network and shows what came of it. `network`: workers and strictness.
int run_mission_concurrently(const MissionOptions& options, const NetworkOptions& network,
                             const Context& context);

}  // namespace segue::cli
