// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/task/component.hpp>

#include <string_view>
#include <vector>

namespace segue::task {

/// Keeps one or two components from creating or destroying ports while an object lives, so that pointers to
/// ports are safe in any thread even though an exception can destroy dynamic ports at any time. Hold it
/// briefly, since others wait. Meanwhile ports may be read and connected; creating or destroying ports of
/// these components, calling their inputs() or find_...(), and waiting for a task would deadlock.
class HeldPorts {
 public:
  explicit HeldPorts(const Component& component) : HeldPorts(component, component) {}
  /// Holds both components; they may be the same.
  HeldPorts(const Component& component, const Component& other);
  ~HeldPorts();
  HeldPorts(const HeldPorts&) = delete;
  HeldPorts& operator=(const HeldPorts&) = delete;

  /// Require that the component is one of those held.
  [[nodiscard]] const std::vector<InputPortBase*>& inputs(const Component& component) const {
    return component.inputs_;
  }
  [[nodiscard]] const std::vector<OutputPortBase*>& outputs(const Component& component) const {
    return component.outputs_;
  }
  [[nodiscard]] InputPortBase* find_input(const Component& component, std::string_view name) const;
  [[nodiscard]] OutputPortBase* find_output(const Component& component, std::string_view name) const;

 private:
  // In the order of their addresses, so that nobody deadlocks; both may be the same.
  Mutex& first_;
  Mutex& second_;
};

}  // namespace segue::task
