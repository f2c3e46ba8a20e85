// SPDX-License-Identifier: Apache-2.0
#include <segue/draw/transition_picture.hpp>

#include <segue/base/text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include <segue/draw/svg.hpp>
#include <segue/draw/transition_schedule.hpp>
#include <segue/draw/transition_style.hpp>

namespace segue::draw {

namespace {

using model::Action;
using model::Phase;
using svg::Out;

constexpr std::array kPhases = {Phase::Prepare, Phase::Commit, Phase::Retire};
constexpr double kMargin = 16;
constexpr double kTop = 60;
constexpr double kBandHead = 38;
constexpr double kAxis = 18;
constexpr double kRow = 18;
constexpr double kBar = 14;
constexpr double kLeastBand = 128;
constexpr double kLetter = 6.1;      ///< of text of size 11, generously
constexpr double kBoldLetter = 6.9;  ///< of bold text of size 11, generously
constexpr std::size_t kLongestLabel = 60;
constexpr std::string_view kSmall = "font-size=\"11\"";

/// The actions of one task, process or connection that do not overlap.
struct Row {
  std::string subject;
  std::vector<std::size_t> actions;  ///< places in the list
  double begin = 0;
};

std::string subject_of(const Action& action) {
  std::string subject = action.label().substr(to_string(action.kind).size() + 1);
  // The policy is left out, so that a connection that is replaced stays in its row.
  if (std::holds_alternative<model::ConnectionAction>(action.what))
    subject.resize(std::min(subject.size(), subject.find(" (")));
  return subject;
}

/// Shortens both ends of a connection.
std::string shortened(const std::string& label) {
  constexpr std::string_view kArrow = " -> ";
  const std::size_t arrow = label.find(kArrow);
  if (arrow == std::string::npos || label.size() <= kLongestLabel)
    return svg::shortened(label, kLongestLabel);
  const std::size_t from = arrow;
  const std::size_t to = label.size() - arrow - kArrow.size();
  const std::size_t room = kLongestLabel - kArrow.size();
  const std::size_t for_from = std::max(room / 2, to < room / 2 ? room - to : 0);
  const std::size_t for_to = room - std::min(from, for_from);
  return svg::shortened(label.substr(0, arrow), for_from) + std::string(kArrow) +
         svg::shortened(label.substr(arrow + kArrow.size()), for_to);
}

bool overlap(const Schedule::Span& a, const Schedule::Span& b) {
  return a.begin < b.end && b.begin < a.end;
}

/// The rows, sorted by their first action.
std::vector<Row> rows_of(const model::Transition& transition, const Schedule& schedule) {
  std::vector<Row> rows;
  std::multimap<std::string, std::size_t> by_subject;
  for (std::size_t i = 0; i < transition.actions.size(); ++i) {
    const std::string subject = subject_of(transition.actions[i]);
    const auto is_free = [&](const auto& entry) {
      return std::ranges::none_of(rows[entry.second].actions, [&](std::size_t other) {
        return overlap(schedule.actions[other], schedule.actions[i]);
      });
    };
    const auto [begin, end] = by_subject.equal_range(subject);
    auto found = std::find_if(begin, end, is_free);
    if (found == end) {
      found = by_subject.emplace(subject, rows.size());
      rows.push_back({subject, {}, schedule.actions[i].begin});
    }
    Row& row = rows[found->second];
    row.actions.push_back(i);
    row.begin = std::min(row.begin, schedule.actions[i].begin);
  }
  std::ranges::stable_sort(rows, {}, &Row::begin);
  return rows;
}

/// Seconds with a unit that fits `most`.
std::string time_text(double seconds, double most) {
  if (most >= 1) return fmt::format("{:.3g} s", seconds);
  if (most >= 1e-3) return fmt::format("{:.3g} ms", seconds * 1e3);
  return fmt::format("{:.3g} \u00b5s", seconds * 1e6);
}

std::string length_text(const Schedule& schedule, double length) {
  if (schedule.measured) return time_text(length, length);
  return fmt::format("{:g} step{}", length, length == 1 ? "" : "s");
}

class Picture {
 public:
  Picture(const model::Transition& transition, const std::vector<Duration>& durations)
      : transition_(transition),
        schedule_(schedule_of(transition, durations)),
        rows_(rows_of(transition, schedule_)),
        critical_(schedule_.critical.begin(), schedule_.critical.end()) {
    std::size_t longest = 8;
    for (const Row& row : rows_)
      longest = std::max(longest, std::min(row.subject.size(), kLongestLabel));
    left_ = kMargin + static_cast<double>(longest) * kBoldLetter + 10;
    place_bands();
    legend_height_ = draw_legend(nullptr);
  }

  std::string draw() {
    svg::begin(out_, width(), bottom() + legend_height_ + kMargin);
    draw_title();
    for (const Phase phase : kPhases)
      draw_band(phase);
    for (std::size_t i = 0; i < rows_.size(); ++i)
      draw_row_label(i);
    draw_critical_path();
    for (std::size_t i = 0; i < rows_.size(); ++i)
      draw_bars(i);
    draw_legend(&out_);
    return std::move(file_.append(svg::kEnd));
  }

 private:
  struct Band {
    double x = 0;
    double width = 0;
  };

  /// Steps have one width everywhere. Times differ too much: each phase has a scale of its own.
  void place_bands() {
    const double total = schedule_.length();
    const double step = std::clamp(1500 / std::max(total, 1.0), 18.0, 96.0);
    double x = left_;
    for (std::size_t i = 0; i < bands_.size(); ++i) {
      const double length = schedule_.phases.at(i).length();
      const double width =
          schedule_.measured ? 200 + 800 * length / total : std::max(kLeastBand, length * step);
      bands_.at(i) = {x, has_actions(kPhases.at(i)) ? width : 0};
      x += bands_.at(i).width;
    }
  }

  [[nodiscard]] bool has_actions(Phase phase) const {
    return std::ranges::any_of(transition_.actions,
                               [&](const Action& action) { return action.phase == phase; });
  }
  [[nodiscard]] double right() const { return bands_.back().x + bands_.back().width; }
  [[nodiscard]] double width() const { return std::max(right() + kMargin, 680.0); }
  [[nodiscard]] double first_row() const { return kTop + kBandHead + (schedule_.measured ? kAxis : 0); }
  [[nodiscard]] double bottom() const { return first_row() + kRow * static_cast<double>(rows_.size()) + 4; }
  [[nodiscard]] double middle_of(std::size_t row) const {
    return first_row() + kRow * (static_cast<double>(row) + 0.5) + 2;
  }

  [[nodiscard]] double x_of(Phase phase, double time) const {
    const auto number = static_cast<std::size_t>(phase);
    const Schedule::Span& span = schedule_.phases.at(number);
    const Band& band = bands_.at(number);
    return span.length() > 0 ? band.x + (time - span.begin) / span.length() * band.width : band.x;
  }

  void draw_title() {
    const auto name = [](const model::NetworkName& network) {
      return network.empty() ? std::string("empty") : network.str();
    };
    const std::size_t count = transition_.actions.size();
    svg::text(out_, kMargin, 26, "start", name(transition_.from) + " \u2192 " + name(transition_.to),
              "font-size=\"16\" font-weight=\"bold\"");
    std::string text = counted(count, "action");
    if (count == 0) text = "nothing to do";
    if (count > 0) {
      text += fmt::format(", critical path {}, order {}", length_text(schedule_, schedule_.length()),
                          to_string(transition_.order));
    }
    svg::text(out_, kMargin, 46, "start", text);
  }

  void draw_band(Phase phase) {
    const Band& band = bands_.at(static_cast<std::size_t>(phase));
    if (band.width == 0) return;
    svg::rect(out_, band.x, kTop, band.width, bottom() - kTop, fmt::format("fill=\"{}\"", tint_of(phase)));
    draw_grid(phase, band);
    svg::line(out_, band.x, kTop, band.x, bottom(), "stroke=\"#999999\"");
    const auto count = std::ranges::count(transition_.actions, phase, &Action::phase);
    const std::string actions = counted(static_cast<std::size_t>(count), "action");
    const double length = schedule_.phases.at(static_cast<std::size_t>(phase)).length();
    svg::text(out_, band.x + 8, kTop + 16, "start", to_string(phase), "font-weight=\"bold\"");
    svg::text(out_, band.x + 8, kTop + 31, "start", actions + ", " + length_text(schedule_, length), kSmall);
  }

  void draw_grid(Phase phase, const Band& band) {
    const Schedule::Span& span = schedule_.phases.at(static_cast<std::size_t>(phase));
    if (span.length() <= 0) return;
    const double step = schedule_.measured ? tick_of(span.length(), band.width) : 1;
    for (int i = 0; i * step <= span.length() * 1.0001; ++i) {
      const double x = x_of(phase, span.begin + i * step);
      svg::line(out_, x, first_row(), x, bottom(), "stroke=\"#dddddd\"");
      if (!schedule_.measured || x > band.x + band.width - 30) continue;
      svg::text(out_, x + 3, first_row() - 5, "start", time_text(i * step, span.length()),
                "font-size=\"10\" fill=\"#666666\"");
    }
  }

  /// 1, 2 or 5 times a power of ten, with room for its text.
  static double tick_of(double length, double width) {
    const double least = length / width * 64;
    const double power = std::pow(10, std::floor(std::log10(least)));
    for (const double factor : {1.0, 2.0, 5.0}) {
      if (factor * power >= least) return factor * power;
    }
    return 10 * power;
  }

  [[nodiscard]] bool is_critical(std::size_t action) const {
    return critical_.contains(static_cast<int>(action));
  }

  void draw_row_label(std::size_t number) {
    const Row& row = rows_[number];
    const double y = middle_of(number);
    svg::line(out_, kMargin, y + kRow / 2, right(), y + kRow / 2, "stroke=\"#e6e6e6\"");
    const bool bold =
        std::ranges::any_of(row.actions, [&](std::size_t action) { return is_critical(action); });
    svg::text(out_, left_ - 8, y + 4, "end", shortened(row.subject),
              bold ? "font-size=\"11\" font-weight=\"bold\"" : kSmall);
  }

  void draw_bars(std::size_t number) {
    for (const std::size_t place : rows_[number].actions) {
      const Action& action = transition_.actions[place];
      const Schedule::Span& span = schedule_.actions[place];
      const double x = x_of(action.phase, span.begin);
      const double width = std::max(x_of(action.phase, span.end) - x - 2, 2.0);
      const double y = middle_of(number) - kBar / 2;
      const KindStyle& style = style_of(action.kind);
      std::string look = fmt::format("rx=\"2\" fill=\"{}\"", style.fill);
      if (is_critical(place)) look += fmt::format(" stroke=\"{}\" stroke-width=\"2\"", kCriticalColour);
      svg::rect(out_, x + 1, y, width, kBar, look, tooltip(action, span));
      const std::string_view kind = to_string(action.kind);
      if (width < static_cast<double>(kind.size()) * kLetter + 4) continue;
      svg::text(out_, x + 1 + width / 2, y + 11, "middle", kind,
                fmt::format("font-size=\"11\" fill=\"{}\"", style.text));
    }
  }

  [[nodiscard]] std::string tooltip(const Action& action, const Schedule::Span& span) const {
    std::string text = fmt::format("{}: {}", action.id, action.label());
    if (schedule_.measured) text += ", " + time_text(span.length(), span.length());
    return text;
  }

  [[nodiscard]] std::size_t row_of(int action) const {
    const auto row = std::ranges::find_if(rows_, [&](const Row& candidate) {
      return std::ranges::find(candidate.actions, static_cast<std::size_t>(action)) !=
             candidate.actions.end();
    });
    return static_cast<std::size_t>(row - rows_.begin());
  }

  /// Draws a line wherever one action of the critical path ends and the next begins.
  void draw_critical_path() {
    const std::string style =
        fmt::format("stroke=\"{}\" stroke-width=\"1.5\" stroke-dasharray=\"3 2\"", kCriticalColour);
    for (std::size_t i = 1; i < schedule_.critical.size(); ++i) {
      const int next = schedule_.critical[i];
      const Action& action = transition_.actions[static_cast<std::size_t>(next)];
      const double x = x_of(action.phase, schedule_.actions[static_cast<std::size_t>(next)].begin);
      svg::line(out_, x, middle_of(row_of(schedule_.critical[i - 1])), x, middle_of(row_of(next)), style);
    }
  }

  /// Returns the height of the legend; draws it unless `out` is null.
  double draw_legend(Out* out) const {
    double x = kMargin;
    double y = bottom() + 24;
    const auto put = [&](std::string_view name, const std::string& box) {
      const double needed = 18 + static_cast<double>(name.size()) * kLetter + 14;
      if (x + needed > width() - kMargin && x > kMargin) {
        x = kMargin;
        y += 20;
      }
      if (out != nullptr) {
        svg::rect(*out, x, y - 10, 12, 12, "rx=\"2\" " + box);
        svg::text(*out, x + 18, y, "start", name, kSmall);
      }
      x += needed;
    };
    const model::ActionCounts counts = transition_.counts();
    for (std::size_t i = 0; i < counts.by_kind.size(); ++i) {
      if (counts.by_kind.at(i) > 0)
        put(model::kActionKindNames.at(i), fmt::format("fill=\"{}\"", kKindStyles.at(i).fill));
    }
    if (!transition_.actions.empty()) {
      put("critical path", fmt::format("fill=\"white\" stroke=\"{}\" stroke-width=\"2\"", kCriticalColour));
    }
    y += 20;
    if (out != nullptr) {
      svg::text(*out, kMargin, y, "start",
                schedule_.measured ? "Typical durations as estimated; each phase has a scale of its own."
                                   : "Durations are not known: every action is one step.",
                "font-size=\"11\" fill=\"#666666\"");
    }
    return y - bottom();
  }

  const model::Transition& transition_;
  const Schedule schedule_;
  const std::vector<Row> rows_;
  const std::set<int> critical_;
  std::array<Band, 3> bands_;
  double left_ = 0;
  double legend_height_ = 0;
  std::string file_;
  Out out_{file_};
};

}  // namespace

std::string to_svg(const model::Transition& transition, const std::vector<Duration>& durations) {
  return Picture(transition, durations).draw();
}

}  // namespace segue::draw
