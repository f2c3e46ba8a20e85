// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace segue::task {

class Component;

/// A sub-state of Running, as a member of its component: `State driving_{*this, "driving"};`. It lasts until
/// another one is entered, and ends with Running. The port `state` tells it as a number
/// (kFirstNominalState), in the order of construction.
class State {
 public:
  State(Component& component, std::string name);
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  /// For hooks and operations in the task's thread, while Running; in on_start() it says how Running begins.
  /// Elsewhere it is ignored, with a warning. Real-time safe. Requires a task.
  void enter() const;

 private:
  Component& component_;
  std::uint32_t number_;
};

/// A sub-state of RunTimeError, likewise a member: `ErrorState blocked_{*this, "blocked"};`. Entered by
/// Component::error().
class ErrorState {
 public:
  ErrorState(Component& component, std::string name);
  ErrorState(const ErrorState&) = delete;
  ErrorState& operator=(const ErrorState&) = delete;

 private:
  friend class Component;
  const Component& component_;
  std::uint32_t number_;
};

}  // namespace segue::task
