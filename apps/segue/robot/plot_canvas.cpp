// SPDX-License-Identifier: Apache-2.0
#include "plot_canvas.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

namespace segue::cli {

namespace {

constexpr std::array kPlotColours = {Colour::Green, Colour::Yellow, Colour::Blue, Colour::Red};

Colour plot_colour(std::size_t line) {
  return kPlotColours[line % kPlotColours.size()];
}

/// Dots that are drawn as braille characters.
class Canvas {
 public:
  Canvas(std::size_t columns, std::size_t rows) : columns_(columns), cells_(columns * rows) {}
  [[nodiscard]] std::size_t width() const { return columns_ * kAcross; }
  [[nodiscard]] std::size_t height() const { return cells_.size() / columns_ * kDown; }

  /// The dot at `x` from the left and `y` from the top. A character has the colour of its last dot.
  void dot(std::size_t x, std::size_t y, Colour colour) {
    // The order in which Unicode numbers the dots.
    constexpr std::array<std::array<std::uint8_t, kDown>, kAcross> kBits = {
        {{0x01, 0x02, 0x04, 0x40}, {0x08, 0x10, 0x20, 0x80}}};
    Cell& cell = cells_[y / kDown * columns_ + x / kAcross];
    cell.bits |= kBits[x % kAcross][y % kDown];
    cell.colour = colour;
  }

  [[nodiscard]] std::string row(std::size_t row) const {
    std::string text;
    for (std::size_t column = 0; column < columns_; ++column) {
      const Cell& cell = cells_[row * columns_ + column];
      const std::string braille = {'\xe2', static_cast<char>(0xa0 | cell.bits >> 6U),
                                   static_cast<char>(0x80 | (cell.bits & 0x3fU))};
      text += cell.bits == 0 ? " " : coloured(cell.colour, braille);
    }
    return text.substr(0, text.find_last_not_of(' ') + 1);
  }

 private:
  static constexpr std::size_t kAcross = 2;
  static constexpr std::size_t kDown = 4;
  struct Cell {
    std::uint8_t bits = 0;
    Colour colour = Colour::Green;
  };
  std::size_t columns_;
  std::vector<Cell> cells_;
};

struct Scale {
  double least = 0;
  double most = 0;
};

/// Of what is shown; never empty.
Scale scale_of(std::span<const PlotLine> lines, const PlotView& view) {
  std::optional<Scale> scale;
  for (const PlotLine& line : lines) {
    for (const auto& point : line.points) {
      if (point.time_s < view.from_s || point.time_s > view.to_s || !std::isfinite(point.value)) continue;
      if (!scale) scale = Scale{point.value, point.value};
      scale->least = std::min(scale->least, point.value);
      scale->most = std::max(scale->most, point.value);
    }
  }
  if (!scale) return {-1, 1};
  if (scale->least < scale->most) return *scale;
  const double margin = std::max(std::abs(scale->least) / 10, 1e-3);
  return {scale->least - margin, scale->most + margin};
}

/// The dot for a number between two others.
std::size_t place(double value, double from, double to, std::size_t dots) {
  const double part = to > from ? std::clamp((value - from) / (to - from), 0.0, 1.0) : 0;
  return static_cast<std::size_t>(std::lround(part * static_cast<double>(dots - 1)));
}

void draw_line(Canvas& canvas, const PlotLine& line, Colour colour, const PlotView& view,
               const Scale& scale) {
  struct Dot {
    double x = 0;
    double y = 0;
  };
  Dot last;
  bool is_joined = false;  // to the last dot
  for (const auto& point : line.points) {
    if (point.time_s < view.from_s || point.time_s > view.to_s) continue;
    if (!std::isfinite(point.value)) {
      is_joined = false;
      continue;
    }
    const Dot dot{static_cast<double>(place(point.time_s, view.from_s, view.to_s, canvas.width())),
                  static_cast<double>(canvas.height() - 1 -
                                      place(point.value, scale.least, scale.most, canvas.height()))};
    const Dot from = is_joined ? last : dot;
    const double steps = std::max({std::abs(dot.x - from.x), std::abs(dot.y - from.y), 1.0});
    for (double step = 0; step <= steps; ++step) {
      canvas.dot(static_cast<std::size_t>(std::lround(from.x + (dot.x - from.x) * step / steps)),
                 static_cast<std::size_t>(std::lround(from.y + (dot.y - from.y) * step / steps)), colour);
    }
    last = dot;
    is_joined = true;
  }
}

std::string names_text(std::span<const PlotLine> lines, std::size_t columns) {
  std::string text;
  for (std::size_t at = 0; at < lines.size(); ++at) {
    const auto& points = lines[at].points;
    const std::string number = points.empty() || !std::isfinite(points.back().value)
                                   ? "-"
                                   : fmt::format("{:.6g}", points.back().value);
    const std::string name = fmt::format("{}: {}", lines[at].name, number).substr(0, columns);
    text += coloured(plot_colour(at), name) + '\n';
  }
  return text;
}

}  // namespace

std::string plot_text(std::span<const PlotLine> lines, const PlotView& view) {
  const Scale scale = scale_of(lines, view);
  const std::string most = fmt::format("{:.4g}", scale.most);
  const std::string least = fmt::format("{:.4g}", scale.least);
  const std::size_t margin = std::max(most.size(), least.size());
  const std::size_t rows = std::max(view.rows, lines.size() + 3) - lines.size() - 1;
  const std::size_t columns = std::max<std::size_t>(view.columns, 20) - margin - 2;
  Canvas canvas(columns, rows);
  for (std::size_t at = 0; at < lines.size(); ++at)
    draw_line(canvas, lines[at], plot_colour(at), view, scale);
  std::string text = names_text(lines, view.columns);
  for (std::size_t row = 0; row < rows; ++row) {
    const std::string& label = row == 0 ? most : row + 1 == rows ? least : std::string();
    text += fmt::format("{:>{}} |{}\n", label, margin, canvas.row(row));
  }
  const std::string from = fmt::format("{:.1f} s", view.from_s);
  const std::string to = fmt::format("{:.1f} s", view.to_s);
  return text + fmt::format("{:>{}} {}{:>{}}\n", "", margin, from, to, columns + 1 - from.size());
}

}  // namespace segue::cli
