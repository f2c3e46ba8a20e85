// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

/// Layout of an acyclic graph: boxes in layers from left to right, so that lines cross and bend little.
namespace segue::draw {

/// A line between two boxes.
struct LayoutLine {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  bool cut = false;           ///< too long, or leads into another row: only its end is drawn
  std::vector<double> via{};  ///< the heights at which it passes the layers between
  double leaves = 0;          ///< heights at the boxes
  double arrives = 0;
};

struct Layout {
  std::vector<std::uint32_t> layer;  ///< by box
  std::vector<double> top;           ///< by box
  std::vector<double> height;        ///< by box: with room for all lines that arrive
  std::uint32_t layers = 0;
  std::uint32_t per_row = 0;  ///< layers; those that follow stand in another row below
  double bottom = 0;
  [[nodiscard]] std::uint32_t column(std::uint32_t box) const { return layer[box] % per_row; }
  [[nodiscard]] std::uint32_t columns() const { return layers < per_row ? layers : per_row; }
};

inline constexpr std::uint32_t kOneRow = 0xFFFFFFFF;

/// Lines that pass more layers than this are cut.
inline constexpr std::uint32_t kLongestLine = 8;

/// Lines must lead from lower to higher numbers; fills in the rest of them. `least` is the height of a box,
/// `lane` that of a line. Layers as of Sugiyama, Tagawa and Toda, "Methods for visual understanding of
/// hierarchical system structures" (1981): longest paths, then barycentres, then heights as near to the
/// neighbours' as the order allows. After `per_row` layers a new row begins. Time grows with boxes and lines,
/// times the logarithm of a layer's size.
Layout lay_out(std::size_t boxes, std::vector<LayoutLine>& lines, double least, double lane,
               std::uint32_t per_row = kOneRow);

/// How many layers a row may have so that the rows together are about as wide as a page. `one_row` is the
/// layout without rows, `width` that of a layer with the lines after it. kOneRow if that is not much wider
/// than a page.
std::uint32_t layers_for_page(const Layout& one_row, double width);

}  // namespace segue::draw
