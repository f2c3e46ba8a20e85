// SPDX-License-Identifier: Apache-2.0
#include "mission_progress.hpp"

#include <segue/base/log.hpp>
#include <segue/base/text.hpp>
#include <segue/concurrent/thread.hpp>

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "../output.hpp"

namespace segue::cli {

namespace {

using Kind = mission::StateEvent::Kind;

/// Drawings in a second, if events keep coming; as many may come at once after a pause.
constexpr double kMostDrawings = 10;
constexpr Duration kBetweenDrawings = std::chrono::milliseconds(100);
constexpr Duration kRefresh = std::chrono::seconds(1);
/// More lines of either kind are counted, not shown.
constexpr std::size_t kMostShown = 8;

std::string label_of(const mission::StateEvent& event) {
  std::string label(event.path);
  return event.iteration == 0 ? label : label + '#' + std::to_string(event.iteration);
}

/// A line that wraps would be more than one, and could not be rewritten.
std::string cut_to(std::string line, std::size_t columns) {
  line = printable(line);
  if (line.size() < columns) return line;
  std::size_t end = columns > 4 ? columns - 4 : 0;
  while (end > 0 && (static_cast<unsigned char>(line[end]) & 0xC0U) == 0x80U)
    --end;
  return line.substr(0, end) + "...";
}

}  // namespace

MissionProgress::MissionProgress(std::string name, Style style, bool with_time, draw::Diagram plan)
    : name_(std::move(name)), style_(style), with_time_(with_time), plan_(std::move(plan)) {
  if (style_ != Style::Block) return;
  set_log_sink([this](LogLevel level, std::string_view source, std::string_view message) {
    const Lock lock(mutex_);
    clear_block();
    print_error_line(fmt::format("{}: {}: {}", to_string(level), source, message));
  });
  thread_ = concurrent::start_thread("segue-progress", [this] { refresh(); });
}

MissionProgress::~MissionProgress() {
  if (style_ == Style::Block) set_log_sink({});
  {
    const Lock lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
  const Lock lock(mutex_);
  clear_block();
}

void MissionProgress::observe(const mission::StateEvent& event) {
  if (style_ == Style::None) return;
  const Lock lock(mutex_);
  if (style_ != Style::Block) return print_event(event);
  if (event.is_container) return;
  const TimePoint now = RealClock::instance().now();
  const std::string label = label_of(event);
  if (event.kind == Kind::Began) {
    plan_.began(label);
    running_.insert_or_assign(label, now);
  } else {
    plan_.ended(label, std::string(event.outcome));
    running_.erase(label);
    ++ended_;
    last_ = label + ": " + std::string(event.outcome);
  }
  credit_ = std::min(kMostDrawings, credit_ + kMostDrawings * seconds(now - seen_));
  seen_ = now;
  if (credit_ >= 1) {
    credit_ -= 1;
    draw_block();
  } else {
    is_stale_ = true;
    wake_.notify_all();
  }
}

void MissionProgress::note(const std::string& text) {
  const Lock lock(mutex_);
  clear_block();
  print_note(text);
}

void MissionProgress::print_event(const mission::StateEvent& event) const {
  const bool began = event.kind == Kind::Began;
  const double time = seconds_since(begin_);
  if (style_ == Style::JsonEvents) {
    type::Value value = type::Value::map({{"kind", began ? "began" : "ended"},
                                          {"name", std::string(event.path)},
                                          {"iteration", event.iteration}});
    if (event.is_container) value.as_map().set("container", true);
    if (with_time_) value.as_map().set("time_s", time);
    if (!began) value.as_map().set("outcome", std::string(event.outcome));
    if (!event.error.empty()) value.as_map().set("error", std::string(event.error));
    return print_json_line(value);
  }
  std::string line = with_time_ ? fmt::format("{:>8.2f} s  ", time) : std::string();
  line += printable(fmt::format("{} {}", began ? "began" : "ended", label_of(event)));
  if (!began) line += printable(fmt::format(": {}", event.outcome));
  if (!event.error.empty()) line += printable(fmt::format(" ({})", event.error));
  style_ == Style::Lines ? print_error_line(line) : print_line(line);
}

void MissionProgress::refresh() {
  Lock lock(mutex_);
  while (!stopping_) {
    wake_.wait_for(mutex_, kRefresh, [&]() SEGUE_REQUIRES(mutex_) { return stopping_ || is_stale_; });
    if (is_stale_)
      wake_.wait_for(mutex_, kBetweenDrawings, [&]() SEGUE_REQUIRES(mutex_) { return stopping_; });
    if (!stopping_) draw_block();
  }
}

double MissionProgress::seconds_since(TimePoint when) const {
  return seconds(RealClock::instance().now() - when);
}

std::vector<std::string> MissionProgress::lines() const {
  const auto waiting = plan_.waiting(kMostShown);
  std::size_t width = 0;
  for (const auto& [label, since] : running_)
    width = std::max(width, label.size());
  for (const auto& one : waiting)
    width = std::max(width, one.node.size());
  std::vector<std::string> lines = {fmt::format("{}: {} running, {} done, {:.1f} s{}", name_, running_.size(),
                                                ended_, seconds_since(begin_),
                                                last_.empty() ? "" : "; last " + last_)};
  for (const auto& [label, since] : running_) {
    if (lines.size() > kMostShown) break;
    lines.push_back(fmt::format("  running  {:<{}}  {:.1f} s", label, width, seconds_since(since)));
  }
  for (const auto& one : waiting)
    lines.push_back(fmt::format("  waits    {:<{}}  for {}", one.node, width, listed(one.waits_for)));
  return lines;
}

void MissionProgress::draw_block() {
  for (const std::string& discarded : plan_.off_path())
    running_.erase(discarded);
  const std::size_t columns = terminal_columns(STDERR_FILENO);
  std::string text = shown_ > 0 ? fmt::format("\x1b[{}A\r\x1b[J", shown_) : std::string();
  shown_ = 0;
  for (const std::string& line : lines()) {
    text += cut_to(line, columns) + '\n';
    ++shown_;
  }
  fmt::print(stderr, "{}", text);
  std::fflush(stderr);
  is_stale_ = false;
}

void MissionProgress::clear_block() {
  if (shown_ == 0) return;
  fmt::print(stderr, "\x1b[{}A\r\x1b[J", shown_);
  std::fflush(stderr);
  shown_ = 0;
}

}  // namespace segue::cli
