// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <span>
#include <string>
#include <string_view>

#include "../output.hpp"

/// Plots in a terminal.
namespace segue::cli {

/// The numbers of a field over time.
struct PlotLine {
  struct Point {
    double time_s = 0;
    double value = 0;  ///< not finite: the line is interrupted there
  };
  std::string name;
  std::deque<Point> points;  ///< in the order of their times
};

struct PlotView {
  double from_s = 0;  ///< points before are not shown
  double to_s = 0;
  std::size_t columns = 80;  ///< of the whole picture; at least 20
  std::size_t rows = 24;     ///< of the whole picture, with a line for each name; at least 3 more than lines
};

/// The lines over time, in braille characters of which each has two by four dots, below their names with
/// their last numbers. The scale is that of what is shown.
std::string plot_text(std::span<const PlotLine> lines, const PlotView& view);

}  // namespace segue::cli
