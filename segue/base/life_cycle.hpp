// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace segue {

/// The states of a task. The first three are targets that a network may ask for; the last three are errors.
enum class TaskState : std::uint8_t { PreOperational, Stopped, Running, RunTimeError, Exception, Fatal };

inline constexpr std::array<std::string_view, 6> kTaskStateNames = {"pre_operational", "stopped",   "running",
                                                                    "run_time_error",  "exception", "fatal"};

inline std::string_view to_string(TaskState state) {
  return kTaskStateNames.at(static_cast<std::size_t>(state));
}

/// The state of that name, ignoring case; nothing if there is none.
std::optional<TaskState> task_state_from(std::string_view name);

inline bool is_error(TaskState state) {
  return state >= TaskState::RunTimeError;
}

/// Whether a task in this state is configured and has its dynamic ports. Not so in Exception, which is
/// entered after the stop and cleanup hooks have run.
inline bool is_configured(TaskState state) {
  return state == TaskState::Stopped || state == TaskState::Running || state == TaskState::RunTimeError;
}

}  // namespace segue
