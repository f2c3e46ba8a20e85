// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/mission/action_runner.hpp>

#include <cstddef>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "planned_nodes.hpp"

namespace segue::cli {

/// Shows a run while it goes on: as a block of lines that is rewritten on a terminal, as a line for each
/// event elsewhere. On standard error, but events that are asked for (`--follow`) on standard output. All
/// functions may be called from any thread.
class MissionProgress {
 public:
  enum class Style {
    None,
    Block,      ///< rewritten, at most ten times a second
    Lines,      ///< a line on standard error for each event
    Events,     ///< a line on standard output for each event
    JsonEvents  ///< a line of JSON for each event on standard output
  };
  /// `plan`: what is known of it in advance, empty if nothing. `with_time`: in real time.
  MissionProgress(std::string name, Style style, bool with_time, draw::Diagram plan);
  /// Removes the block.
  ~MissionProgress();
  MissionProgress(const MissionProgress&) = delete;
  MissionProgress& operator=(const MissionProgress&) = delete;

  void observe(const mission::StateEvent& event);
  /// A note on standard error, beside whatever is shown.
  void note(const std::string& text);

 private:
  void print_event(const mission::StateEvent& event) const;
  /// Redraws the block while time passes, though nothing happens.
  void refresh();
  void draw_block() SEGUE_REQUIRES(mutex_);
  void clear_block() SEGUE_REQUIRES(mutex_);
  [[nodiscard]] std::vector<std::string> lines() const SEGUE_REQUIRES(mutex_);
  [[nodiscard]] double seconds_since(TimePoint when) const;

  const std::string name_;
  const Style style_;
  const bool with_time_;
  const TimePoint begin_ = RealClock::instance().now();

  Mutex mutex_;  ///< protects all below
  PlannedNodes plan_ SEGUE_GUARDED_BY(mutex_);
  std::map<std::string, TimePoint> running_ SEGUE_GUARDED_BY(mutex_);
  std::size_t ended_ SEGUE_GUARDED_BY(mutex_) = 0;
  std::string last_ SEGUE_GUARDED_BY(mutex_);       ///< the last one to end, and how
  std::size_t shown_ SEGUE_GUARDED_BY(mutex_) = 0;  ///< lines of the block that is on the terminal
  double credit_ SEGUE_GUARDED_BY(mutex_) = 0;      ///< how many drawings may follow at once
  TimePoint seen_ SEGUE_GUARDED_BY(mutex_){};       ///< the last event
  bool is_stale_ SEGUE_GUARDED_BY(mutex_) = false;  ///< the block does not show the last event yet
  bool stopping_ SEGUE_GUARDED_BY(mutex_) = false;
  ConditionVariable wake_;
  std::thread thread_;
};

}  // namespace segue::cli
