// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

#include <chrono>
#include <cstdint>
#include <ratio>

namespace segue::task_network {

/// How much speculation had done before it was needed, and how much for nothing.
struct SpeculationSummary {
  std::uint64_t used = 0;       ///< nodes of which the run that counts was speculative
  Duration ahead{};             ///< work of these that was done before it was certain that they count
  std::uint64_t discarded = 0;  ///< runs
  Duration discarded_time{};    ///< of these
};

/// Times that the makespan of a run is compared with.
struct RunSummary {
  Duration sequential{};     ///< sequential time
  Duration critical_path{};  ///< lower bound of the makespan, whatever the resources
  Duration shortest{};       ///< lower bound of the makespan with the resources that there are
  /// Processor time of the engine's thread for each node.
  std::chrono::duration<double, std::micro> engine_per_node{};
  SpeculationSummary speculation{};
};

}  // namespace segue::task_network
