// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <string>

/// Estimates for people and tools.
namespace segue::cli {

/// Lines, from the JSON of `diff`: the ranges of total and phases, the critical path, and the number of
/// actions never measured; "" where it has no estimate or no actions.
std::string estimate_text(const type::Value& transition);

/// "; expected 2.1 ms to 4.0 ms (commit 1.0 ms to 1.6 ms)" from a finished transition's JSON; "" without
/// a prediction.
std::string expectation_of(const type::Value& result);

/// Counts how often predictions were right.
class Forecasts {
 public:
  /// Counts a finished transition (JSON) if its outcome is done and it has a prediction.
  void add(const type::Value& result);
  /// A sentence; "" without predictions.
  [[nodiscard]] std::string verdict() const;

 private:
  int count_ = 0;
  int total_right_ = 0;
  int commit_right_ = 0;
};

}  // namespace segue::cli
