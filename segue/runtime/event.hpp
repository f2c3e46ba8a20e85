// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

namespace segue::runtime {

enum class EventKind {
  RequestAccepted,
  TransitionStarted,
  ActionDone,
  ActionFailed,
  TransitionCommitted,
  TransitionDone,
  TransitionFailed,
  TransitionUndone,
  RequestRefused,
  RequestSuperseded,
  TaskState,
  Process,
  Difference,
  BeliefReset,
  Repair,
  GivenUp,
  Prepared,
  Journal,
  HostLost,   ///< a computer cannot be reached any more
  HostFound,  ///< it can again
  Files,      ///< files were applied, or that was rolled back
  Lease,      ///< somebody commands the robot, or does no longer
  RequestCancelled,
  Halt,     ///< the robot is brought to rest, or was released
  Pool,     ///< an instance of a pool is made because calls wait, or ended because none do
  Units,    ///< somebody has said how many units of a resource there are
  Property  ///< somebody has set a property of a task that is there
};
std::string_view to_string(EventKind kind);

/// Events are numbered from 1 without gaps; the last few thousand are kept.
struct Event {
  std::uint64_t number = 0;
  std::chrono::system_clock::time_point time;
  EventKind kind = EventKind::RequestAccepted;
  std::string subject;  ///< a task, action or network
  std::string message;
  bool trouble =
      false;  ///< something has gone wrong: whatever failed, was refused, given up, lost or differs
};

}  // namespace segue::runtime
