// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mission_network.hpp"
#include "mission_run.hpp"

namespace segue::cli {

/// Runs a mission as a task network and shows what came of it. `network`: workers and strictness.
int run_mission_concurrently(const MissionOptions& options, const NetworkOptions& network,
                             const Context& context);

}  // namespace segue::cli
