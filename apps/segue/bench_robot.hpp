// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/transition.hpp>

#include <memory>

#include "bench_experiment.hpp"

namespace segue::cli {

/// A robot of its own with the bench components, switched in that order, its files in a folder that goes with
/// it. Its destructor brings it to rest: no task and no process stays. What an earlier run left behind is
/// taken down first. AlreadyExists while another such robot of this user runs.
Result<std::unique_ptr<BenchRobot>> make_bench_robot(Placement placement, model::Order order);

}  // namespace segue::cli
