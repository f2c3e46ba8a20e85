// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/model/ids.hpp>
#include <segue/model/transition.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

/// Measured durations of actions, from which estimates are computed. Plain values.
namespace segue::model {

/// A process executes actions sequentially as long as they are quicker than this; the next one is executed
/// beside a slower one.
inline constexpr Duration kQuickAction = std::chrono::microseconds(200);

/// An uncertain duration.
struct DurationRange {
  Duration low{0};
  Duration typical{0};
  Duration high{0};

  [[nodiscard]] bool contains(Duration duration) const { return low <= duration && duration <= high; }
  friend bool operator==(const DurationRange&, const DurationRange&) = default;
};

/// Stand for the component in keys of connect and disconnect, which depend on the processes of the two tasks.
inline constexpr std::string_view kWithinProcess = "(within a process)";
inline constexpr std::string_view kBetweenProcesses = "(between processes)";

/// The key that the duration of an action depends on.
struct ActionKey {
  /// Of a task: its component; of a call "component.operation"; of a process: its deployer; of a connection
  /// one of the above. Empty: unknown.
  std::string component;
  ActionKind kind = ActionKind::Recover;
  HostName host;

  friend bool operator==(const ActionKey&, const ActionKey&) = default;
  friend auto operator<=>(const ActionKey&, const ActionKey&) = default;
};

/// Statistics of the durations of one key: their number, their mean, and the latest ones, oldest first.
struct DurationRecord {
  static constexpr std::size_t kRecent = 32;

  std::uint64_t count = 0;
  Duration mean{0};
  std::vector<Duration> recent;

  void add(Duration duration) {
    ++count;
    mean += (duration - mean) / static_cast<std::int64_t>(count);
    if (recent.size() >= kRecent) recent.erase(recent.begin());
    recent.push_back(duration);
  }
  friend bool operator==(const DurationRecord&, const DurationRecord&) = default;
};

/// How long actions took in the past.
struct ActionTimes {
  std::map<ActionKey, DurationRecord> actions;
  /// Waiting times: from the end of an action's predecessors to its reported end, less its own duration and
  /// those of quick actions of its process.
  DurationRecord waits;

  friend bool operator==(const ActionTimes&, const ActionTimes&) = default;
};

}  // namespace segue::model
