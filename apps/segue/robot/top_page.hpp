// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/type/value.hpp>

#include <cstddef>
#include <map>
#include <optional>
#include <string>

/// The pages of `segue top`.
namespace segue::cli {

/// The share of a processor that each task used between the last two looks at it.
class ProcessorShares {
 public:
  /// Takes the processor times of a status, which was asked for at that time.
  void look_at(const type::Value& status, TimePoint now);
  /// 1: a whole processor. Nothing where the task has been looked at once only.
  [[nodiscard]] std::optional<double> of(const std::string& task) const;

 private:
  struct Use {
    double cpu_us = 0;  ///< at the last look
    std::optional<double> share;
  };
  std::map<std::string, Use> uses_;
  TimePoint last_{};
};

/// Sorts the tasks of a status by "name", or the greatest first by "cpu" (their share, else their processor
/// time so far), "worst", "latency" or "missed".
void sort_tasks(type::Value& status, const std::string& key, const ProcessorShares& shares);

struct PageSize {
  std::size_t columns = 80;
  std::size_t rows = 24;
};

/// The robot and its controller in a line.
std::string top_heading(const type::Value& status);

/// The state of the robot, its tasks in their order, and connections that dropped samples, in two lines less
/// than the page has. "... N more" tells where something does not fit.
std::string top_page(const type::Value& status, const ProcessorShares& shares, PageSize size);

}  // namespace segue::cli
