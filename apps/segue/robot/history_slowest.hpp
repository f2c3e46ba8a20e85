// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/journal/entries.hpp>
#include <segue/type/value.hpp>

#include <cstddef>
#include <string>
#include <vector>

/// `segue history --slowest`: the actions of past transitions that took longest (Wirkus et al. 2020, Table
/// 6).
namespace segue::cli {

/// An action with all its executions that ended as they should, in seconds.
struct SlowAction {
  std::string label;      ///< "configure slam"
  std::string component;  ///< empty: none, as of a process
  model::ActionKind kind = model::ActionKind::Recover;
  model::Phase phase = model::Phase::Commit;  ///< of the last execution
  std::size_t count = 0;
  double sum = 0;
  double most = 0;

  [[nodiscard]] double mean() const { return sum / static_cast<double>(count); }
};

/// The `limit` whose mean is largest, slowest first.
std::vector<SlowAction> slowest_actions(const std::vector<journal::TransitionEntry>& transitions,
                                        std::size_t limit);

/// How whoever wrote the component or the network can make it faster; empty: it is fast.
std::string hint_about(const SlowAction& action);

std::string slowest_text(const std::vector<SlowAction>& actions);
type::Value::List slowest_value(const std::vector<SlowAction>& actions);

}  // namespace segue::cli
