// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/draw/task_graph.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <segue/draw/layout_path.hpp>
#include <segue/draw/svg.hpp>

namespace segue::draw {

namespace {

constexpr double kLeast = 40;  ///< least height of a box
constexpr double kLane = 18;   ///< height of a line, with its label
constexpr std::string_view kForward = "#2b6cb0";
constexpr std::string_view kBack = "#b7791f";
/// Of processes, in the order of their names; that of the runtime is white.
constexpr std::array<std::string_view, 8> kFills{"#dce6f2", "#e3f0df", "#f6e6d3", "#e9dcf2",
                                                 "#d8efee", "#f7dfe3", "#efeccd", "#e4e4e4"};

class Drawing {
 public:
  explicit Drawing(const TaskGraph& graph) : graph_(graph), order_(order_of_flow(graph)) {
    std::map<std::string_view, std::uint32_t> place;
    for (const std::uint32_t task : order_)
      place.emplace(graph.tasks[task].id, static_cast<std::uint32_t>(place.size()));
    for (const TaskGraph::Task& task : graph.tasks) {
      if (!task.process.empty()) fills_.emplace(task.process, "");
    }
    std::size_t next = 0;
    for (auto& [process, fill] : fills_)
      fill = kFills.at(next++ % kFills.size());
    for (const TaskGraph::Connection& connection : graph.connections) {
      const std::uint32_t from = place.at(connection.from_task);
      const std::uint32_t to = place.at(connection.to_task);
      if (from == to) {
        loops_[from].append(loops_[from].empty() ? "" : ", ").append(connection.from_port);
        continue;
      }
      lines_.push_back({std::min(from, to), std::max(from, to)});
      shown_.push_back({&connection, from > to});
    }
    std::vector<LayoutLine> lines = lines_;
    const Layout one_row = lay_out(order_.size(), lines, kLeast, kLane);
    layout_ = lay_out(order_.size(), lines_, kLeast, kLane, layers_for_page(one_row, kMeasures.layer()));
  }

  std::string draw() {
    const double width = std::max(kMeasures.width_of(layout_), 480.0);
    svg::begin(out_, std::ceil(width), std::ceil(kMeasures.top + layout_.bottom + kMeasures.margin), 11,
               graph_.name);
    svg::text(out_, kMeasures.margin, 20, "start", graph_.name, "font-size='15' font-weight='bold'");
    svg::text(out_, kMeasures.margin, 37, "start",
              counted(graph_.tasks.size(), "task") + ", " + counted(graph_.connections.size(), "connection"),
              "fill='#555555'");
    legend();
    for (std::size_t i = 0; i < lines_.size(); ++i)
      line(lines_[i], shown_[i]);
    for (std::uint32_t i = 0; i < order_.size(); ++i)
      box(i);
    return std::move(text_.append(svg::kEnd));
  }

 private:
  struct Shown {
    const TaskGraph::Connection* connection;
    bool back;  ///< closes a loop: it leads against the order
  };
  static constexpr LayoutMeasures kMeasures{.box = 190, .curve = 60, .label = 170};

  void legend() {
    double x = kMeasures.margin;
    for (const auto& [process, fill] : fills_) {
      svg::rect(out_, x, 48, 12, 12, fmt::format("rx='2' fill='{}' stroke='#888888'", fill));
      svg::text(out_, x + 17, 58, "start", process);
      x += 34 + 6.2 * static_cast<double>(process.size());
    }
    if (std::ranges::none_of(shown_, &Shown::back)) return;
    svg::line(out_, x, 54, x + 22, 54, fmt::format("stroke='{}' stroke-dasharray='5 3'", kBack));
    svg::text(out_, x + 28, 58, "start", "closes a loop");
  }

  /// A cut line names the task at its far end.
  std::string label_of(const LayoutLine& line, const Shown& shown) const {
    const TaskGraph::Connection& one = *shown.connection;
    const std::string far = line.cut ? graph_.tasks[order_[line.from]].id + "." : "";
    const bool is_short = !line.cut && one.from_port == one.to_port;
    const std::string ports = shown.back ? far + one.to_port + " ← " + one.from_port
                              : is_short ? one.to_port
                                         : far + one.from_port + " → " + one.to_port;
    return one.policy == "data" ? ports : ports + " (" + one.policy + ")";
  }
  static std::string title_of(const TaskGraph::Connection& one) {
    return fmt::format("{}.{} -> {}.{} ({})", one.from_task, one.from_port, one.to_task, one.to_port,
                       one.policy);
  }

  void arrow(double x, double y, bool back) {
    svg::path(out_, fmt::format("M{:.1f} {:.1f}l{} -3v6z", x, y, back ? 6 : -6),
              fmt::format("fill='{}'", back ? kBack : kForward));
  }

  void line(const LayoutLine& line, const Shown& shown) {
    const double end = kMeasures.left_of(layout_, layout_.column(line.to));
    const double y = kMeasures.top + line.arrives;
    const std::string style = fmt::format("stroke='{}' fill='none'{}", shown.back ? kBack : kForward,
                                          shown.back ? " stroke-dasharray='5 3'" : "");
    svg::begin_group(out_, title_of(*shown.connection));
    double tip = shown.back ? kMeasures.left_of(layout_, layout_.column(line.from)) + kMeasures.box : end;
    if (line.cut) {
      const double far = end - kMeasures.label;
      svg::line(out_, far, y, end - 1, y, style);
      svg::circle(out_, far, y, 2.5, fmt::format("fill='{}'", shown.back ? kBack : kForward));
      tip = shown.back ? far + 2 : end;
    } else {
      svg::path(out_, path_of(line, layout_, kMeasures), style);
    }
    arrow(tip, shown.back && !line.cut ? kMeasures.top + line.leaves : y, shown.back);
    svg::text(out_, end - 8, y - 3, "end", svg::shortened(label_of(line, shown), 30),
              fmt::format("font-size='10' fill='{}'", shown.back ? kBack : kForward));
    svg::end_group(out_);
  }

  void box(std::uint32_t number) {
    const TaskGraph::Task& task = graph_.tasks[order_[number]];
    const double x = kMeasures.left_of(layout_, layout_.column(number));
    const double y = kMeasures.top + layout_.top[number];
    const double middle = y + layout_.height[number] / 2;
    const auto fill = fills_.find(task.process);
    std::string title = task.id + "\n" + task.component + ", " + task.state;
    if (!task.process.empty()) title += "\nin " + task.process;
    if (!task.unwritten.empty()) title += "\nnothing writes to " + listed(task.unwritten);
    if (const auto loop = loops_.find(number); loop != loops_.end())
      title += "\nreads its own output " + loop->second;
    svg::begin_group(out_, title);
    svg::rect(
        out_, x, y, kMeasures.box, layout_.height[number],
        fmt::format("rx='4' fill='{}' stroke='#888888'", fill == fills_.end() ? "white" : fill->second));
    svg::text(out_, x + 8, middle - 3, "start", svg::shortened(task.id, 26), "font-weight='bold'");
    svg::text(out_, x + 8, middle + 11, "start", svg::shortened(task.component + ", " + task.state, 31),
              "font-size='10' fill='#333333'");
    svg::end_group(out_);
  }

  const TaskGraph& graph_;
  const std::vector<std::uint32_t> order_;
  std::map<std::string, std::string_view> fills_;  ///< by process
  std::map<std::uint32_t, std::string> loops_;     ///< by box: outputs that it reads itself
  std::vector<LayoutLine> lines_;
  std::vector<Shown> shown_;  ///< by line
  Layout layout_;
  std::string text_;
  svg::Out out_{text_};
};

}  // namespace

std::string to_svg(const TaskGraph& graph) {
  return Drawing(graph).draw();
}

}  // namespace segue::draw
