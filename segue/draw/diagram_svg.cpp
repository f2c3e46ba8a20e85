// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include <segue/draw/diagram_style.hpp>
#include <segue/draw/layout_path.hpp>
#include <segue/draw/svg.hpp>

namespace segue::draw {

namespace {

constexpr double kLeast = 36;  ///< least height of a box
constexpr double kLane = 14;   ///< height of a line
constexpr LayoutMeasures kMeasures;

class Drawing {
 public:
  explicit Drawing(const Diagram& diagram)
      : diagram_(diagram), boxes_(static_cast<std::uint32_t>(std::min(diagram.nodes.size(), kMostDrawn))) {
    for (std::uint32_t i = 0; i < boxes_; ++i) {
      for (const Diagram::Dependency& dependency : diagram.nodes[i].before) {
        if (dependency.implied) continue;
        lines_.push_back({dependency.from, i});
        dependencies_.push_back(&dependency);
      }
    }
    std::vector<LayoutLine> lines = lines_;
    const Layout one_row = lay_out(boxes_, lines, kLeast, kLane);
    layout_ = lay_out(boxes_, lines_, kLeast, kLane, layers_for_page(one_row, kMeasures.layer()));
  }

  std::string draw() {
    const double width = std::max(kMeasures.width_of(layout_), 760.0);
    const double height = kMeasures.top + layout_.bottom + kMeasures.margin;
    svg::begin(out_, std::ceil(width), std::ceil(height), 11, diagram_.name);
    text(kMeasures.margin, 20, "start", diagram_.name, "font-size='15' font-weight='bold'");
    text(kMeasures.margin, 37, "start", caption_of(diagram_), "fill='#555555'");
    legend();
    for (std::size_t i = 0; i < lines_.size(); ++i)
      line(lines_[i], *dependencies_[i]);
    for (std::uint32_t i = 0; i < boxes_; ++i)
      box(i);
    return std::move(text_.append(svg::kEnd));
  }

 private:
  void text(double x, double y, std::string_view anchor, std::string_view content, std::string_view style) {
    svg::text(out_, x, y, anchor, content, style);
  }

  /// Explains the roles and reasons that occur.
  void legend() {
    std::array<bool, 7> roles{};
    std::array<bool, Diagram::kKinds> kinds{};
    for (std::size_t i = 0; i < boxes_; ++i)
      roles.at(static_cast<std::size_t>(diagram_.nodes[i].role)) = true;
    for (const Diagram::Dependency* dependency : dependencies_)
      kinds.at(static_cast<std::size_t>(dependency->causes.front().kind)) = true;
    double x = kMeasures.margin;
    for (std::size_t i = 0; i < roles.size(); ++i) {
      if (!roles.at(i)) continue;
      const auto role = static_cast<Diagram::Role>(i);
      svg::rect(out_, x, 48, 12, 12, fmt::format("rx='2' fill='{}' stroke='#888888'", style_of(role).fill));
      text(x + 17, 58, "start", to_string(role), "");
      x += 34 + 6.2 * static_cast<double>(to_string(role).size());
    }
    x += 20;
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      if (!kinds.at(i)) continue;
      const auto kind = static_cast<Diagram::Kind>(i);
      stroke(x, 54, x + 22, 54, colour_of(kind), true);
      arrow(x + 22, 54, colour_of(kind));
      text(x + 28, 58, "start", to_string(kind), "");
      x += 46 + 6.2 * static_cast<double>(to_string(kind).size());
    }
    std::string notes;
    if (std::ranges::any_of(dependencies_, [](const auto* one) { return !one->holds_start; }))
      notes = "dashed: it may run speculatively, its result waits; ";
    if (std::ranges::any_of(lines_, &LayoutLine::cut)) notes += "dot: from the node with that number; ";
    if (!notes.empty()) text(x, 58, "start", notes.substr(0, notes.size() - 2), "fill='#555555'");
  }

  static std::string line_style(std::string_view colour, bool firm) {
    return fmt::format("stroke='{}' fill='none'{}", colour, firm ? "" : " stroke-dasharray='5 3'");
  }
  void stroke(double x1, double y1, double x2, double y2, std::string_view colour, bool firm) {
    svg::line(out_, x1, y1, x2, y2, line_style(colour, firm));
  }
  void arrow(double x, double y, std::string_view colour) {
    svg::path(out_, fmt::format("M{:.1f} {:.1f}l-6 -3v6z", x, y), fmt::format("fill='{}'", colour));
  }

  /// Names the reasons for a dependency as far as there is room, each in its colour.
  void label(double x, double y, const Diagram::Dependency& dependency, std::string_view prefix) {
    fmt::format_to(out_, "<text x='{:.1f}' y='{:.1f}' text-anchor='end' font-size='10'>", x, y);
    std::size_t room = 21 - prefix.size();
    std::size_t left = dependency.causes.size();
    std::string_view before = prefix;
    for (const Diagram::Cause& cause : dependency.causes) {
      const bool named = cause.kind != Diagram::Kind::Opaque && cause.kind != Diagram::Kind::OpaqueSubtree;
      const std::string own = svg::shortened(named ? cause.subject : std::string(to_string(cause.kind)),
                                             std::max<std::size_t>(room, 6));
      if (left < dependency.causes.size() && own.size() + 4 > room) break;
      fmt::format_to(out_, "<tspan fill='{}'>{}{}</tspan>", colour_of(cause.kind), escape_markup(before),
                     escape_markup(own));
      room -= std::min(room, own.size() + 2);
      before = ", ";
      --left;
    }
    if (left > 0) fmt::format_to(out_, "<tspan fill='#555555'>, +{}</tspan>", left);
    text_ += "</text>\n";
  }

  void line(const LayoutLine& line, const Diagram::Dependency& dependency) {
    const std::string_view colour = colour_of(dependency.causes.front().kind);
    const double end = kMeasures.left_of(layout_, layout_.column(line.to));
    const double y = kMeasures.top + line.arrives;
    svg::begin_group(out_, tooltip_of(diagram_, dependency, line.to));
    std::string prefix;
    if (line.cut) {
      stroke(end - kMeasures.label, y, end - 1, y, colour, dependency.holds_start);
      svg::circle(out_, end - kMeasures.label, y, 2.5, fmt::format("fill='{}'", colour));
      prefix = fmt::format("{}: ", line.from);
    } else {
      svg::path(out_, path_of(line, layout_, kMeasures), line_style(colour, dependency.holds_start));
    }
    arrow(end, y, colour);
    label(end - 8, y - 3, dependency, prefix);
    svg::end_group(out_);
  }

  void box(std::uint32_t number) {
    const Diagram::Node& node = diagram_.nodes[number];
    const RoleStyle style = style_of(node.role);
    const double x = kMeasures.left_of(layout_, layout_.column(number));
    const double y = kMeasures.top + layout_.top[number];
    const double height = layout_.height[number];
    svg::begin_group(out_, fmt::format("{} {}\n{}", number, node.name, tooltip_of(node)));
    svg::rect(out_, x, y, kMeasures.box, height,
              fmt::format("rx='4' fill='{}' stroke='#888888'", style.fill));
    // The container is written below, so only the last part of the path is.
    const auto inside = node.container.empty() ? 0 : node.container.size() + 1;
    const std::string own = node.name.substr(std::min(inside, node.name.size()));
    const std::string fill = fmt::format("fill='{}'", style.text);
    text(x + 8, y + height / 2 - 3, "start", fmt::format("{} {}", number, svg::shortened(own, 20)),
         "font-weight='bold' " + fill);
    std::string below(node.note == "opaque" ? node.note : to_string(node.role));
    if (node.duration > Duration::zero()) below += ", " + format_duration(node.duration);
    if (!node.container.empty())
      below = svg::shortened(node.container, 26 - std::min<std::size_t>(below.size(), 20)) + ", " + below;
    text(x + 8, y + height / 2 + 11, "start", svg::shortened(below, 28), "font-size='10' " + fill);
    svg::end_group(out_);
  }

  const Diagram& diagram_;
  const std::uint32_t boxes_;
  std::vector<LayoutLine> lines_;
  std::vector<const Diagram::Dependency*> dependencies_;  ///< by line
  Layout layout_;
  std::string text_;
  svg::Out out_{text_};
};

}  // namespace

std::string to_svg(const Diagram& diagram) {
  return Drawing(diagram).draw();
}

}  // namespace segue::draw
