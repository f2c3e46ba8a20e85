// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/model/transition.hpp>
#include <segue/runtime/switch_result.hpp>
#include <segue/type/value.hpp>

#include <map>
#include <string>
#include <utility>
#include <vector>

/// The results of `segue bench transitions`: all transitions between a robot's controllers, as Tables 5 to 7
/// of Wirkus et al. 2020 have them. Times are in seconds.
namespace segue::cli {

/// One transition, executed several times.
struct MeasuredTransition {
  std::vector<double> seconds;                         ///< from the request until all is done
  std::vector<double> commit;                          ///< in which alone control is interrupted
  model::ActionCounts counts;                          ///< of the last execution
  std::map<std::string, std::vector<double>> actions;  ///< by label, "configure arm"
};

struct TransitionsReport {
  std::string robot;
  std::vector<std::string> controllers;  ///< in the order of rows and columns
  /// By the controllers that it leads from and to.
  std::map<std::pair<std::string, std::string>, MeasuredTransition> transitions;
  std::vector<double> published;  ///< row by row, without the diagonal; empty: none
};

/// Adds a switch that was done, and how long it took from the request on.
void add_switch(MeasuredTransition& transition, const runtime::SwitchResult& result, double seconds);

/// A walk that begins at the first controller, and has a switch from each to each other one; few are
/// repeated.
std::vector<std::string> walk_between(const std::vector<std::string>& controllers);

/// The matrix of the times, the numbers of actions, and the slowest actions of each transition.
std::string transitions_text(const TransitionsReport& report);
type::Value transitions_value(const TransitionsReport& report);
/// Every execution.
std::string transitions_csv(const TransitionsReport& report);

}  // namespace segue::cli
