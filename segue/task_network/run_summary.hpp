// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

namespace segue::task_network {

/// Figures that a run is compared with.
struct RunSummary {
  Duration sequential{};     ///< sequential time
  Duration critical_path{};  ///< lower bound of the makespan, whatever the resources
  Duration shortest{};       ///< lower bound of the makespan with the resources that there are
  double engine_us_per_node = 0;
};

}  // namespace segue::task_network
