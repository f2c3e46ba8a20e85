// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/draw/layout.hpp>

#include <fmt/format.h>

#include <iterator>
#include <string>

namespace segue::draw {

/// The measures of a picture of a layout, in pixels. A column is a box, then room in which lines bend, then
/// room for the lines' labels.
struct LayoutMeasures {
  double box = 170;
  double curve = 70;
  double label = 120;
  double margin = 16;
  double top = 78;  ///< of the highest box
  [[nodiscard]] double layer() const { return box + curve + label; }
  /// Lines that arrive in the first column of a further row need room for their labels.
  [[nodiscard]] double left_of(const Layout& layout, std::uint32_t column) const {
    return margin + (layout.layers > layout.per_row ? label : 0) + column * layer();
  }
  [[nodiscard]] double width_of(const Layout& layout) const {
    return left_of(layout, layout.columns() > 0 ? layout.columns() - 1 : 0) + box + margin;
  }
};

/// A line that is not cut, from box to box, as in the attribute `d`; it ends a pixel before the box.
inline std::string path_of(const LayoutLine& line, const Layout& layout, const LayoutMeasures& measures) {
  double x = measures.left_of(layout, layout.column(line.from)) + measures.box;
  double y = measures.top + line.leaves;
  std::string path = fmt::format("M{:.1f} {:.1f}", x, y);
  const auto bend_to = [&](double to) {
    fmt::format_to(std::back_inserter(path), "C{:.1f} {:.1f} {:.1f} {:.1f} {:.1f} {:.1f}",
                   x + measures.curve / 2, y, x + measures.curve / 2, to, x + measures.curve, to);
    y = to;
  };
  for (const double via : line.via) {
    bend_to(measures.top + via);
    x += measures.layer();
    fmt::format_to(std::back_inserter(path), "H{:.1f}", x);
  }
  bend_to(measures.top + line.arrives);
  return fmt::format("{}H{:.1f}", path, measures.left_of(layout, layout.column(line.to)) - 1);
}

}  // namespace segue::draw
