// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/life_cycle.hpp>
#include <segue/base/result.hpp>
#include <segue/model/ids.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace segue::task_host {

/// How a task is.
struct TaskLevel {
  TaskState state = TaskState::PreOperational;
  std::string state_name;     ///< the named sub-state, or the state's own name
  std::uint64_t updates = 0;  ///< since its last start
  friend bool operator==(const TaskLevel&, const TaskLevel&) = default;
};

/// A question for how a task is, from somebody who wants to hear of changes.
struct LevelQuestion {
  model::TaskId task;
  std::optional<TaskLevel> seen{};  ///< what whoever asks knows; nothing: the answer comes at once
  bool each_update = false;         ///< another count of updates is a change, too

  [[nodiscard]] bool is_news(const TaskLevel& level) const {
    return !seen || level.state != seen->state || level.state_name != seen->state_name ||
           (each_update && level.updates != seen->updates);
  }
};

/// Gets the answer, once, from any thread, also before the function that asks returns. Must not block.
using LevelAnswer = std::function<void(Result<TaskLevel>)>;

}  // namespace segue::task_host
