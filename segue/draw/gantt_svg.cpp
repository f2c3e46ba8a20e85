// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/draw/gantt.hpp>
#include <segue/draw/svg.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace segue::draw {

namespace {

constexpr int kRow = 18;
constexpr int kLabels = 190;
constexpr int kWidth = 900;
constexpr int kTop = 56;
constexpr std::string_view kSpeculative = "fill='#e6a700'";

/// The longest name, in characters.
constexpr std::size_t kLongest = 26;

class Drawing {
 public:
  explicit Drawing(const Gantt& gantt) : gantt_(gantt), last_(seconds_of(gantt.makespan)) {
    for (const Gantt::Bar& bar : gantt.bars)
      last_ = std::max(last_, seconds(bar.until));
    unwanted_ = static_cast<std::size_t>(std::ranges::count_if(gantt.nodes, is_unwanted));
  }

  std::string draw() {
    text(4, 16, head(), "font-size='13'");
    legend();
    const std::size_t rows = gantt_.nodes.size() - unwanted_ + (unwanted_ > 0 ? 1 : 0);
    axis(kTop + kRow * static_cast<int>(rows + 1 + gantt_.resources.size()));
    y_ = kTop;
    by_node();
    y_ += kRow;
    by_resource();
    std::string file;
    svg::begin(svg::Out(file), kLabels + kWidth + 30, y_ + 30, 11, head());
    return file.append(body_).append(svg::kEnd);
  }

 private:
  static double seconds_of(Duration duration) { return std::chrono::duration<double>(duration).count(); }
  static double seconds(TimePoint time) { return seconds_of(time.time_since_epoch()); }
  static bool is_unwanted(const Gantt::Node& node) {
    return node.status == task_network::NodeStatus::Skipped && node.bars.empty();
  }
  [[nodiscard]] std::string head() const {
    std::string text =
        fmt::format("{}: {} in {:.2f} s", gantt_.name, gantt_.outcome, seconds_of(gantt_.makespan));
    const double sequential = seconds_of(gantt_.summary.sequential);
    if (sequential <= 0 || gantt_.makespan <= Duration{}) return text;
    return text + fmt::format("; sequential time {:.2f} s, critical path {:.2f} s, speed-up {:.2f}",
                              sequential, seconds_of(gantt_.summary.critical_path),
                              sequential / seconds_of(gantt_.makespan));
  }
  [[nodiscard]] double x(double time) const { return kLabels + (last_ > 0 ? time / last_ * kWidth : 0); }

  void text(double at, int y, std::string_view content, std::string_view style = "") {
    svg::text(out_, at, y, "start", content, style);
  }

  void bar(double from, double until, int y, int height, std::string_view style, const std::string& title) {
    svg::rect(out_, x(from), y, std::max(1.0, x(until) - x(from)), height, style, title);
  }

  static std::string_view wait_colour(task_network::Wait::Kind kind) {
    switch (kind) {
      case task_network::Wait::Kind::Data:
        return "fill='#9ecae1'";
      case task_network::Wait::Kind::Condition:
        return "fill='#c994c7'";
      case task_network::Wait::Kind::World:
        return "fill='#a1d99b'";
      case task_network::Wait::Kind::Resource:
        return "fill='#fdae6b'";
      case task_network::Wait::Kind::Turn:
        break;
    }
    return "fill='#c7c7c7'";
  }

  static std::string_view run_colour(ActionClass kind) {
    switch (kind) {
      case ActionClass::Irreversible:
        return "fill='#4a4a4a'";
      case ActionClass::Pure:
        return "fill='#3182bd'";
      case ActionClass::Sensing:
        break;
    }
    return "fill='#31a354'";
  }

  void legend() {
    struct Entry {
      const char* name;
      std::string_view style;
    };
    const Entry entries[] = {{"irreversible", "fill='#4a4a4a'"},
                             {"pure", "fill='#3182bd'"},
                             {"sensing", "fill='#31a354'"},
                             {"speculative, used", kSpeculative},
                             {"discarded", "fill='none' stroke='#d62728' stroke-dasharray='3 2'"},
                             {"waits for data", "fill='#9ecae1'"},
                             {"for a condition", "fill='#c994c7'"},
                             {"for a precondition", "fill='#a1d99b'"},
                             {"for a resource", "fill='#fdae6b'"},
                             {"for program order", "fill='#c7c7c7'"},
                             {"critical chain", "fill='none' stroke='#d62728' stroke-width='2'"}};
    int at = 4;
    for (const Entry& entry : entries) {
      svg::rect(out_, at, 26, 12, 10, entry.style);
      text(at + 16, 35, entry.name);
      at += 26 + 11 * static_cast<int>(std::string_view(entry.name).size()) / 2;
    }
  }

  void by_node() {
    for (const Gantt::Node& node : gantt_.nodes) {
      if (is_unwanted(node)) continue;
      const bool done = node.status == task_network::NodeStatus::Done;
      text(4, y_ + 11, svg::shortened(node.name, kLongest),
           done                                              ? ""
           : node.status == task_network::NodeStatus::Failed ? "fill='#d62728'"
                                                             : "fill='#999'");
      for (const task_network::Wait& wait : node.waits)
        draw_wait(wait);
      for (const std::uint32_t one : node.bars)
        run(gantt_.bars[one], node.critical);
      y_ += kRow;
    }
    if (unwanted_ == 0) return;
    text(4, y_ + 11, fmt::format("and {} not on the path taken", unwanted_), "fill='#999'");
    y_ += kRow;
  }

  void draw_wait(const task_network::Wait& wait) {
    const std::string whom =
        index(wait.node) == task_network::kNone ? "" : gantt_.nodes[index(wait.node)].name;
    bar(seconds(wait.from), seconds(wait.until), y_ + 5, 4, wait_colour(wait.kind),
        fmt::format("waits for {}, until {:.2f} s", to_string(wait, whom), seconds(wait.until)));
  }

  void run(const Gantt::Bar& one, bool critical) {
    const Gantt::Node& node = gantt_.nodes[one.node];
    const std::string title =
        fmt::format("{}: {:.2f} to {:.2f} s{}", node.name, seconds(one.from), seconds(one.until),
                    one.wasted         ? ", discarded"
                    : node.speculative ? ", speculative, used"
                                       : "");
    std::string style(one.wasted ? "fill='none' stroke='#d62728' stroke-dasharray='3 2'"
                                 : run_colour(node.kind));
    if (critical && !one.wasted) style += " stroke='#d62728' stroke-width='2'";
    bar(seconds(one.from), seconds(one.until), y_ + 1, 12, style, title);
    if (node.speculative && !one.wasted)
      bar(seconds(one.from), seconds(one.until), y_ + 14, 2, kSpeculative, title);
  }

  void by_resource() {
    for (const Gantt::Resource& resource : gantt_.resources) {
      text(4, y_ + 11, svg::shortened(resource.name, kLongest));
      for (const std::uint32_t place : resource.bars) {
        const Gantt::Bar& one = gantt_.bars[place];
        run(one, false);
        const double room = x(seconds(one.until)) - x(seconds(one.from));
        const std::string& name = gantt_.nodes[one.node].name;
        if (room > 7.0 * static_cast<double>(name.size()))
          text(x(seconds(one.from)) + 3, y_ + 11, name, "fill='white' font-size='10'");
      }
      y_ += kRow;
    }
  }

  void axis(int bottom) {
    if (last_ <= 0) return;
    double step = std::pow(10, std::floor(std::log10(last_ / 4)));
    step *= last_ / step > 20 ? 5 : last_ / step > 10 ? 2 : 1;
    for (double time = 0; time <= last_ * 1.0001; time += step) {
      svg::line(out_, x(time), 50, x(time), bottom, "stroke='#ddd'");
      text(x(time) - 8, bottom + 14, fmt::format("{:g} s", time));
    }
  }

  const Gantt& gantt_;
  double last_;
  std::size_t unwanted_ = 0;  ///< off the path and never run: they get no row
  int y_ = 0;
  std::string body_;
  svg::Out out_{body_};
};

}  // namespace

std::string to_svg(const Gantt& gantt) {
  return Drawing(gantt).draw();
}

}  // namespace segue::draw
