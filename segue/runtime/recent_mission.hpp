// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/journal/entries.hpp>
#include <segue/type/value.hpp>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>

namespace segue::runtime::detail {

/// The mission that commands the robot, or the last one that did, for whoever looks at it
/// (control::RobotService::mission). Bounded. Not thread safe; nothing blocks.
class RecentMission {
 public:
  static constexpr std::size_t kMostEntries = 20'000;
  static constexpr std::size_t kMostAtOnce = 2'000;

  /// A mission's own begin replaces what is known of the last one.
  void add(const journal::MissionEntry& entry);
  void set_plan(type::Value plan);
  /// Not only an outline (control::RobotService::mission).
  [[nodiscard]] bool has_whole_plan() const { return !plan_.is_null() && plan_.find("outline") == nullptr; }

  /// Null where no mission has begun yet. `doing`: what it reports (control::RobotService::report) while it
  /// has not ended. `comes_to_rest`: it counts as "stopping" although it has ended.
  [[nodiscard]] type::Value to_value(std::uint64_t after, bool with_plan, const type::Value& doing,
                                     bool comes_to_rest) const;

 private:
  struct Numbered {
    std::uint64_t number = 0;
    journal::MissionEntry entry;
  };

  std::uint64_t runs_ = 0;      ///< missions so far
  std::uint64_t entries_ = 0;   ///< of all missions
  journal::MissionEntry last_;  ///< of the mission itself
  std::deque<Numbered> kept_;
  std::uint64_t dropped_ = 0;  ///< entries of this mission
  type::Value plan_;
};

}  // namespace segue::runtime::detail
