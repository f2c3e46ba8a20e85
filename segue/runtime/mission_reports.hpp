// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/journal/entries.hpp>
#include <segue/runtime/journaling.hpp>
#include <segue/runtime/recent_mission.hpp>
#include <segue/type/value.hpp>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace segue::runtime::detail {

/// Takes to the journal what a mission that commands the robot says that it did ("happened" of
/// control::RobotService::report), and keeps the recent part of it. The mission runs in a program that may be
/// broken or hostile: its texts are cut, what it says twice counts once, its times lie between the begin of
/// its lease and now, and beyond a thousand entries per second (five thousand at once) they are only counted.
/// Not thread safe; nothing blocks.
class MissionReports {
 public:
  explicit MissionReports(JournalKeeper& journal) : journal_(journal) {}

  /// `holder` commands the robot from now on.
  void begin(std::string holder);
  /// Removes "happened" and "plan" from what the holder says that it is doing.
  void take(type::Value& doing);
  /// It commands the robot no longer. If its mission has not ended, it was lost, and `why` says how.
  void end(const std::string& why);
  [[nodiscard]] const RecentMission& recent() const { return recent_; }

 private:
  using WallTime = std::chrono::system_clock::time_point;

  void take_happened(type::Value& doing);
  void take(const type::Value& one, const std::string& mission, WallTime sent_at, std::int64_t sent);
  void add(journal::MissionEntry entry);
  void refill();
  void tell_lost();

  JournalKeeper& journal_;
  RecentMission recent_;
  std::string holder_;
  WallTime begun_{};                              ///< when the lease began
  std::uint64_t taken_ = 0;                       ///< number of the last entry of this lease
  std::optional<journal::MissionEntry> mission_;  ///< its begin, while it has not ended
  std::uint64_t lost_there_ = 0;                  ///< entries that the mission itself could not keep
  std::uint64_t lost_ = 0;                        ///< entries that are not in the journal as a gap yet
  double credit_ = 0;                             ///< entries that are taken now
  TimePoint refilled_{};
};

}  // namespace segue::runtime::detail
