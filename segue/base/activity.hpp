// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace segue {

/// The event that makes a task's update run.
enum class Trigger : std::uint8_t {
  PortDriven,           ///< a new sample on an input port
  Periodic,             ///< at absolute times that are `period` apart
  FileDescriptorDriven  ///< a descriptor that the component names in on_start becomes readable
};

inline constexpr std::array<std::string_view, 3> kTriggerNames = {"port_driven", "periodic", "fd_driven"};
inline std::string_view to_string(Trigger trigger) {
  return kTriggerNames.at(static_cast<std::size_t>(trigger));
}

enum class Scheduler : std::uint8_t { Normal, Fifo, RoundRobin };

inline constexpr std::array<std::string_view, 3> kSchedulerNames = {"normal", "fifo", "round_robin"};
inline std::string_view to_string(Scheduler scheduler) {
  return kSchedulerNames.at(static_cast<std::size_t>(scheduler));
}

/// The longest Activity::spin: a thread that looks for work for longer than a sleep costs a thousand times
/// over only keeps others from running.
inline constexpr Duration kLongestSpin = std::chrono::milliseconds(10);

/// When and on which thread a task updates.
struct Activity {
  Trigger trigger = Trigger::PortDriven;
  Duration period{0};  ///< Periodic only; > 0
  Scheduler scheduler = Scheduler::Normal;
  int priority = 0;         ///< 1..99 for Fifo and RoundRobin, else 0
  std::vector<int> cpus{};  ///< processors the thread may run on; empty: all
  /// Thread group: tasks of a process that name the same group share its thread. Empty: a thread of its own.
  std::string thread{};
  bool optional = false;  ///< fall back to Normal where the system does not permit the scheduler
  /// How long an update or an operation may take before the task counts as hanging; 0: as deadline_of() says.
  Duration update_deadline{0};
  /// How long the thread goes on looking for work before it sleeps, occupying its processor meanwhile; at
  /// most kLongestSpin. 0: it sleeps at once.
  Duration spin{0};
  /// PortDriven: the inputs whose samples trigger an update. FileDescriptorDriven: the descriptors that do,
  /// by the names that the component gives them. Empty: those that the component chooses. Else always empty.
  std::set<std::string> triggers{};

  friend bool operator==(const Activity&, const Activity&) = default;
};

/// Updates at times that are `period` (> 0) apart.
inline Activity periodic(Duration period) {
  Activity activity;
  activity.trigger = Trigger::Periodic;
  activity.period = period;
  return activity;
}

/// Updates when a descriptor can be read that the component names in on_start.
inline Activity fd_driven() {
  Activity activity;
  activity.trigger = Trigger::FileDescriptorDriven;
  return activity;
}

/// The deadline of each update: the declared one, else ten periods and at least 5 s, else 30 s. Generous,
/// since a task that exceeds it is treated as one that has failed.
inline Duration deadline_of(const Activity& activity) {
  if (activity.update_deadline > Duration::zero()) return activity.update_deadline;
  if (activity.trigger != Trigger::Periodic) return std::chrono::seconds(30);
  constexpr Duration kLeast = std::chrono::seconds(5);
  constexpr Duration kMost = std::chrono::hours(24);
  if (activity.period > kMost / 10) return kMost;
  return activity.period < kLeast / 10 ? kLeast : activity.period * 10;
}

}  // namespace segue
