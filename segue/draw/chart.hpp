// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace segue::draw {

/// A line chart: medians as lines, minimum and maximum as whiskers, on a logarithmic scale of milliseconds.
/// Each line has its own marks, so the chart is readable without colours.
struct Chart {
  struct Point {
    double x = 0;
    std::vector<double> seconds;  ///< at least one, all above 0
  };
  struct Line {
    std::string name;
    std::vector<Point> points;  ///< in the order of x
  };
  std::string title;
  std::string x_label;
  std::vector<Line> lines;
};

/// The chart as an SVG file, without lines that have no points. Texts may hold any characters.
std::string to_svg(const Chart& chart);

/// The median. Requires at least one value; they need not be sorted.
double median_of(std::vector<double> values);

}  // namespace segue::draw
