// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/cdtn/order.hpp>
#include <segue/cdtn/run_result.hpp>
#include <segue/cdtn/task_network.hpp>
#include <segue/cdtn/waits.hpp>
#include <segue/type/value.hpp>

#include <string>
#include <string_view>

namespace segue::cdtn {

/// "done", "skipped" ...
std::string_view to_string(NodeStatus status);
/// "done", "stopped" or "failed".
std::string_view outcome_of(const RunResult& result);

/// Figures that a run is compared with.
struct RunSummary {
  Duration sequential{};     ///< sequential time
  Duration critical_path{};  ///< lower bound of the makespan
  double engine_us_per_node = 0;
};

/// A wait as JSON; `node` is the name of the node whose end it was, or empty.
type::Value to_value(const Wait& wait, const std::string& node);

/// The document that `segue mission run --format json` prints.
type::Value to_value(const TaskNetwork& network, const Order& order, const RunResult& result,
                     const RunSummary& summary);

}  // namespace segue::cdtn
