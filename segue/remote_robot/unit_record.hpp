// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/mission/unit_keeper.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <deque>
#include <string>
#include <utility>

namespace segue::remote_robot {

/// The changes of the robot's units by the runs of missions: they wait here until the robot has taken them
/// (ServedRobot::tell_units). Thread safe; nothing blocks.
class UnitRecord {
 public:
  /// Changes that follow are of a new run, or where `journal` names one, of that run. Returns its name.
  std::string begin(const std::string& journal);
  void changed(const mission::Execution& execution, const mission::UnitChanges& changes);

  [[nodiscard]] bool has_waiting() const;
  /// The oldest changes that wait, of one run, as "units" of control::RobotService::report(), and how many
  /// executions they are of.
  [[nodiscard]] std::pair<type::Value, std::size_t> waiting() const;
  /// The robot has taken so many.
  void taken(std::size_t count);

 private:
  struct Entry {
    std::string run;
    std::string execution;
    mission::UnitChanges changes;
  };
  mutable Mutex mutex_;  ///< protects all below
  std::string run_ SEGUE_GUARDED_BY(mutex_);
  bool has_journal_ SEGUE_GUARDED_BY(mutex_) = false;
  std::uint64_t last_number_ SEGUE_GUARDED_BY(mutex_) = 0;
  std::deque<Entry> waiting_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::remote_robot
