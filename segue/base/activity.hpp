// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

#include <array>
#include <cstdint>
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

  friend bool operator==(const Activity&, const Activity&) = default;
};

}  // namespace segue
