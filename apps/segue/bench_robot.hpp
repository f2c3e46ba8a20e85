// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/transition.hpp>

#include <memory>

#include "bench_experiment.hpp"

namespace segue::cli {

/// A robot with the bench components and a temporary folder for its files. Its destructor ends all tasks and
/// processes. Leftovers of an earlier run are removed first. AlreadyExists while another such robot of this
/// user runs.
Result<std::unique_ptr<BenchRobot>> make_bench_robot(Placement placement, model::Order order);

}  // namespace segue::cli
