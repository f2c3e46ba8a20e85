// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/draw/gantt.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace segue::draw {

namespace {

constexpr int kRow = 18;
constexpr int kLabels = 190;
constexpr int kWidth = 900;
constexpr int kTop = 56;
constexpr std::string_view kAhead = "fill='#e6a700'";

/// Cut between characters, not within one.
std::string_view shortened(std::string_view name) {
  std::size_t end = std::min<std::size_t>(name.size(), 26);
  while (end < name.size() && end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0U) == 0x80U)
    --end;
  return name.substr(0, end);
}

class Drawing {
 public:
  explicit Drawing(const Gantt& gantt) : gantt_(gantt), last_(seconds_of(gantt.makespan)) {
    for (const Gantt::Bar& bar : gantt.bars)
      last_ = std::max(last_, seconds(bar.until));
    unwanted_ = static_cast<std::size_t>(std::ranges::count_if(gantt.nodes, is_unwanted));
  }

  std::string draw() {
    text(4, 16, escape_markup(head()), "font-size='13'");
    legend();
    const std::size_t rows = gantt_.nodes.size() - unwanted_ + (unwanted_ > 0 ? 1 : 0);
    axis(kTop + kRow * static_cast<int>(rows + 1 + gantt_.resources.size()));
    y_ = kTop;
    by_node();
    y_ += kRow;
    by_resource();
    return fmt::format(
        "<svg xmlns='http://www.w3.org/2000/svg' width='{0}' height='{1}' viewBox='0 0 {0} {1}' "
        "font-family='sans-serif' font-size='11' role='img'>\n<title>{2}</title>\n"
        "<rect width='100%' height='100%' fill='white'/>\n{3}</svg>\n",
        kLabels + kWidth + 30, y_ + 30, escape_markup(head()), body_);
  }

 private:
  static double seconds_of(Duration duration) { return std::chrono::duration<double>(duration).count(); }
  static double seconds(TimePoint time) { return seconds_of(time.time_since_epoch()); }
  static bool is_unwanted(const Gantt::Node& node) {
    return node.status == cdtn::NodeStatus::Skipped && node.bars.empty();
  }
  [[nodiscard]] std::string head() const {
    std::string text =
        fmt::format("{}: {} in {:.2f} s", gantt_.name, gantt_.outcome, seconds_of(gantt_.makespan));
    const double sequential = seconds_of(gantt_.summary.sequential);
    if (sequential <= 0 || gantt_.makespan <= Duration{}) return text;
    return text + fmt::format("; one after the other {:.2f} s, critical path {:.2f} s, speed-up {:.2f}",
                              sequential, seconds_of(gantt_.summary.critical_path),
                              sequential / seconds_of(gantt_.makespan));
  }
  [[nodiscard]] double x(double time) const { return kLabels + (last_ > 0 ? time / last_ * kWidth : 0); }

  void text(double at, int y, const std::string& content, std::string_view style = "") {
    fmt::format_to(std::back_inserter(body_), "<text x='{:.1f}' y='{}' {}>{}</text>\n", at, y, style,
                   content);
  }

  /// A bar whose title tells more where a pointer rests on it.
  void bar(double from, double until, int y, int height, std::string_view style, const std::string& title) {
    fmt::format_to(std::back_inserter(body_),
                   "<rect x='{:.1f}' y='{}' width='{:.1f}' height='{}' {}><title>{}</title></rect>\n",
                   x(from), y, std::max(1.0, x(until) - x(from)), height, style, escape_markup(title));
  }

  static std::string_view wait_colour(cdtn::Wait::Kind kind) {
    switch (kind) {
      case cdtn::Wait::Kind::Data:
        return "fill='#9ecae1'";
      case cdtn::Wait::Kind::Condition:
        return "fill='#c994c7'";
      case cdtn::Wait::Kind::World:
        return "fill='#a1d99b'";
      case cdtn::Wait::Kind::Resource:
        return "fill='#fdae6b'";
      case cdtn::Wait::Kind::Turn:
        break;
    }
    return "fill='#c7c7c7'";
  }

  static std::string_view run_colour(cdtn::NodeClass kind) {
    switch (kind) {
      case cdtn::NodeClass::Irreversible:
        return "fill='#4a4a4a'";
      case cdtn::NodeClass::Pure:
        return "fill='#3182bd'";
      case cdtn::NodeClass::Sensing:
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
                             {"ran ahead, and won", kAhead},
                             {"thrown away", "fill='none' stroke='#d62728' stroke-dasharray='3 2'"},
                             {"waits for data", "fill='#9ecae1'"},
                             {"for a condition", "fill='#c994c7'"},
                             {"for the world", "fill='#a1d99b'"},
                             {"for a resource", "fill='#fdae6b'"},
                             {"for its turn", "fill='#c7c7c7'"},
                             {"critical chain", "fill='none' stroke='#d62728' stroke-width='2'"}};
    int at = 4;
    for (const Entry& entry : entries) {
      fmt::format_to(std::back_inserter(body_), "<rect x='{}' y='26' width='12' height='10' {}/>\n", at,
                     entry.style);
      text(at + 16, 35, entry.name);
      at += 30 + 6 * static_cast<int>(std::string_view(entry.name).size());
    }
  }

  void by_node() {
    for (const Gantt::Node& node : gantt_.nodes) {
      if (is_unwanted(node)) continue;
      const bool done = node.status == cdtn::NodeStatus::Done;
      text(4, y_ + 11, escape_markup(shortened(node.name)),
           done                                      ? ""
           : node.status == cdtn::NodeStatus::Failed ? "fill='#d62728'"
                                                     : "fill='#999'");
      for (const cdtn::Wait& wait : node.waits)
        draw_wait(wait);
      for (const std::uint32_t one : node.bars)
        run(gantt_.bars[one], node.critical);
      y_ += kRow;
    }
    if (unwanted_ == 0) return;
    text(4, y_ + 11, fmt::format("and {} not on the path taken", unwanted_), "fill='#999'");
    y_ += kRow;
  }

  void draw_wait(const cdtn::Wait& wait) {
    const std::string whom = index(wait.node) == cdtn::kNone ? "" : gantt_.nodes[index(wait.node)].name;
    bar(seconds(wait.from), seconds(wait.until), y_ + 5, 4, wait_colour(wait.kind),
        fmt::format("waits for {}, until {:.2f} s", to_string(wait, whom), seconds(wait.until)));
  }

  void run(const Gantt::Bar& one, bool critical) {
    const Gantt::Node& node = gantt_.nodes[one.node];
    const std::string title =
        fmt::format("{}: {:.2f} to {:.2f} s{}", node.name, seconds(one.from), seconds(one.until),
                    one.wasted         ? ", thrown away"
                    : node.speculative ? ", ran ahead, and won"
                                       : "");
    std::string style(one.wasted ? "fill='none' stroke='#d62728' stroke-dasharray='3 2'"
                                 : run_colour(node.kind));
    if (critical && !one.wasted) style += " stroke='#d62728' stroke-width='2'";
    bar(seconds(one.from), seconds(one.until), y_ + 1, 12, style, title);
    if (node.speculative && !one.wasted)
      bar(seconds(one.from), seconds(one.until), y_ + 14, 2, kAhead, title);
  }

  void by_resource() {
    for (const Gantt::Resource& resource : gantt_.resources) {
      text(4, y_ + 11, escape_markup(shortened(resource.name)));
      for (const std::uint32_t place : resource.bars) {
        const Gantt::Bar& one = gantt_.bars[place];
        run(one, false);
        const double room = x(seconds(one.until)) - x(seconds(one.from));
        const std::string& name = gantt_.nodes[one.node].name;
        if (room > 7.0 * static_cast<double>(name.size()))
          text(x(seconds(one.from)) + 3, y_ + 11, escape_markup(name), "fill='white' font-size='10'");
      }
      y_ += kRow;
    }
  }

  void axis(int bottom) {
    if (last_ <= 0) return;
    double step = std::pow(10, std::floor(std::log10(last_ / 4)));
    step *= last_ / step > 20 ? 5 : last_ / step > 10 ? 2 : 1;
    for (double time = 0; time <= last_ * 1.0001; time += step) {
      fmt::format_to(std::back_inserter(body_),
                     "<line x1='{0:.1f}' y1='50' x2='{0:.1f}' y2='{1}' stroke='#ddd'/>\n", x(time), bottom);
      text(x(time) - 8, bottom + 14, fmt::format("{:g} s", time));
    }
  }

  const Gantt& gantt_;
  double last_;
  std::size_t unwanted_ = 0;  ///< neither on the path nor run: without a row
  int y_ = 0;
  std::string body_;
};

}  // namespace

std::string to_svg(const Gantt& gantt) {
  return Drawing(gantt).draw();
}

}  // namespace segue::draw
