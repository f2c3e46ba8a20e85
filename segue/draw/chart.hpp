// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace segue::draw {

/// A line chart as SVG: medians as lines, the least and the largest as whiskers, a logarithmic scale of
/// milliseconds. Readable without colours: every line has marks of its own.
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

/// The whole file. Lines without points are left out; texts may hold any characters.
std::string to_svg(const Chart& chart);

/// Of a list that is not empty, in any order.
double median_of(std::vector<double> values);

}  // namespace segue::draw
