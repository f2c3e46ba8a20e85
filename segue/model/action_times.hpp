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

/// How long actions took, as far as it was measured: what estimates are made from. Plain values.
namespace segue::model {

/// A process carries out actions one after the other as long as they are quicker than this; a slower one goes
/// on beside the next (host::Crew).
inline constexpr Duration kQuickAction = std::chrono::microseconds(200);

/// A duration that is not known for certain.
struct DurationRange {
  Duration low{0};
  Duration typical{0};
  Duration high{0};

  [[nodiscard]] bool contains(Duration duration) const { return low <= duration && duration <= high; }
  friend bool operator==(const DurationRange&, const DurationRange&) = default;
};

/// What stands for the component of connect and disconnect: these depend on where the two ends live.
inline constexpr std::string_view kWithinProcess = "(within a process)";
inline constexpr std::string_view kBetweenProcesses = "(between processes)";

/// What the duration of an action depends on.
struct ActionKey {
  /// Of a task: its component; of a call "component.operation"; of a process: its deployer; of a connection
  /// one of the above. Empty: unknown.
  std::string component;
  ActionKind kind = ActionKind::Recover;
  HostName host;

  friend bool operator==(const ActionKey&, const ActionKey&) = default;
  friend auto operator<=>(const ActionKey&, const ActionKey&) = default;
};

/// Durations of the same thing: how many, their mean, and the latest of them, oldest first.
struct DurationRecord {
  static constexpr std::size_t kRecent = 32;

  std::uint64_t count = 0;
  Duration mean{0};
  std::vector<Duration> recent;

  void add(Duration duration);
  friend bool operator==(const DurationRecord&, const DurationRecord&) = default;
};

struct ActionTimes {
  std::map<ActionKey, DurationRecord> actions;
  /// From when an action could have begun, what comes before it done, until its end was known, less what it
  /// took itself and what quick ones of its process took: on the way there and back.
  DurationRecord waits;

  friend bool operator==(const ActionTimes&, const ActionTimes&) = default;
};

}  // namespace segue::model
