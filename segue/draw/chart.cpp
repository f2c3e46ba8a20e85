// SPDX-License-Identifier: Apache-2.0
#include <segue/draw/chart.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <segue/draw/svg.hpp>

namespace segue::draw {

namespace {

constexpr double kWidth = 720;
constexpr double kHeight = 440;
constexpr double kLeft = 80;
constexpr double kRight = 24;
constexpr double kTop = 52;
constexpr double kBottom = 84;

constexpr std::array kColours = {"#1b6ca8", "#c2571a", "#3a7d44", "#7a4a9e"};

/// Maps values to positions in the chart.
struct Scale {
  double x_max = 1;
  double decade_low = 0;  ///< powers of ten, of milliseconds
  double decade_high = 1;

  [[nodiscard]] double x(double value) const { return kLeft + value / x_max * (kWidth - kLeft - kRight); }
  [[nodiscard]] double y(double milliseconds) const {
    const double share = (std::log10(milliseconds) - decade_low) / (decade_high - decade_low);
    return kHeight - kBottom - share * (kHeight - kTop - kBottom);
  }
};

Scale scale_for(const Chart& chart) {
  Scale scale;
  double low = 1e9;
  double high = 0;
  for (const Chart::Line& line : chart.lines) {
    for (const Chart::Point& point : line.points) {
      const auto [least, most] = std::ranges::minmax(point.seconds);
      low = std::min(low, least * 1e3);
      high = std::max(high, most * 1e3);
      scale.x_max = std::max(scale.x_max, point.x);
    }
  }
  if (high > 0) {
    scale.decade_low = std::floor(std::log10(std::max(low, 1e-6)));
    scale.decade_high = std::max(std::ceil(std::log10(high)), scale.decade_low + 1);
  }
  return scale;
}

/// 1, 2 or 5 times a power of ten, so that there are about six of them.
double step_for(double most) {
  const double power = std::pow(10, std::floor(std::log10(most / 6)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (most / (factor * power) <= 7) return std::max(1.0, factor * power);
  }
  return std::max(1.0, 10 * power);
}

using svg::Out;

void draw_grid(Out out, const Scale& scale) {
  constexpr std::string_view kGrid = "stroke=\"#dddddd\"";
  constexpr std::string_view kFineGrid = "stroke=\"#f0f0f0\"";
  for (double decade = scale.decade_low; decade <= scale.decade_high; ++decade) {
    const double value = std::pow(10, decade);
    for (int i = 2; i < 10 && decade < scale.decade_high; ++i)
      svg::line(out, kLeft, scale.y(i * value), kWidth - kRight, scale.y(i * value), kFineGrid);
    svg::line(out, kLeft, scale.y(value), kWidth - kRight, scale.y(value), kGrid);
    svg::text(out, kLeft - 8, scale.y(value) + 4, "end", fmt::format("{:g}", value));
  }
  const double step = step_for(scale.x_max);
  for (double x = 0; x <= scale.x_max * 1.001; x += step) {
    svg::line(out, scale.x(x), kTop, scale.x(x), kHeight - kBottom, kGrid);
    svg::text(out, scale.x(x), kHeight - kBottom + 18, "middle", fmt::format("{:g}", x));
  }
}

void draw_labels(Out out, const Chart& chart) {
  svg::text(out, kWidth / 2, 28, "middle", chart.title, "font-size=\"16\"");
  svg::text(out, (kLeft + kWidth - kRight) / 2, kHeight - kBottom + 40, "middle", chart.x_label);
  svg::text(out, 0, 0, "middle", "milliseconds",
            fmt::format("transform=\"translate(22 {:.1f}) rotate(-90)\"", (kTop + kHeight - kBottom) / 2));
}

/// One shape for each line: circle, square, triangle, diamond.
void draw_mark(Out out, std::size_t number, double x, double y) {
  const std::string style = fmt::format("fill=\"{}\"", kColours[number % kColours.size()]);
  switch (number % 4) {
    case 0:
      svg::circle(out, x, y, 4, style);
      return;
    case 1:
      svg::rect(out, x - 4, y - 4, 8, 8, style);
      return;
    case 2:
      svg::path(out, fmt::format("M{:.1f} {:.1f}l5 9h-10z", x, y - 5), style);
      return;
    default:
      svg::path(out, fmt::format("M{:.1f} {:.1f}l5 5l-5 5l-5 -5z", x, y - 5), style);
  }
}

void draw_data(Out out, const Chart::Line& line, std::size_t number, const Scale& scale) {
  const std::string style = fmt::format("stroke=\"{}\" stroke-width=\"1.5\"", kColours[number % 4]);
  std::string path;
  for (const Chart::Point& point : line.points) {
    const auto [least, most] = std::ranges::minmax(point.seconds);
    const double x = scale.x(point.x);
    path +=
        fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : " L", x, scale.y(median_of(point.seconds) * 1e3));
    svg::line(out, x, scale.y(least * 1e3), x, scale.y(most * 1e3), style);
  }
  svg::path(out, path, "fill=\"none\" " + style);
  for (const Chart::Point& point : line.points)
    draw_mark(out, number, scale.x(point.x), scale.y(median_of(point.seconds) * 1e3));
}

void draw_legend(Out out, const std::vector<Chart::Line>& lines) {
  const double width =
      (kWidth - kLeft - kRight) / static_cast<double>(std::max<std::size_t>(lines.size(), 1));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double x = kLeft + 12 + static_cast<double>(i) * width;
    draw_mark(out, i, x, kHeight - 18);
    svg::text(out, x + 12, kHeight - 14, "start", lines[i].name);
  }
}

}  // namespace

std::string to_svg(const Chart& chart) {
  Chart drawn = chart;
  std::erase_if(drawn.lines, [](const Chart::Line& line) { return line.points.empty(); });
  const Scale scale = scale_for(drawn);
  std::string file;
  const Out out(file);
  svg::begin(out, kWidth, kHeight);
  draw_grid(out, scale);
  draw_labels(out, drawn);
  for (std::size_t i = 0; i < drawn.lines.size(); ++i)
    draw_data(out, drawn.lines[i], i, scale);
  draw_legend(out, drawn.lines);
  return file.append(svg::kEnd);
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace segue::draw
