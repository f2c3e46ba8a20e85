// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

#include <chrono>
#include <ratio>

namespace segue::task_network {

/// Times that the makespan of a run is compared with.
struct RunSummary {
  Duration sequential{};     ///< sequential time
  Duration critical_path{};  ///< lower bound of the makespan, whatever the resources
  Duration shortest{};       ///< lower bound of the makespan with the resources that there are
  /// Processor time of the engine's thread for each node.
  std::chrono::duration<double, std::micro> engine_per_node{};
};

}  // namespace segue::task_network
