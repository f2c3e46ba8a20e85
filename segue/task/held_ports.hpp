// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task/component.hpp>

#include <mutex>
#include <string_view>
#include <vector>

namespace segue::task {

/// Holds the ports of one or two components still: while this lives, none of them is made or destroyed, so
/// that their pointers are safe in any thread, even though a task that breaks unmakes its dynamic ports at
/// any time. Whoever wants to, waits: hold them briefly. What may be done meanwhile is to read the ports and
/// to connect them; not to make or destroy ports of these components, nor to ask them (inputs(), find_...),
/// nor to wait for a task.
class HeldPorts {
 public:
  explicit HeldPorts(const Component& component) : one_(component.ports_mutex_) {}
  /// Both; they may be the same.
  HeldPorts(const Component& component, const Component& other);

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
  std::unique_lock<std::mutex> one_;
  std::unique_lock<std::mutex> other_;
};

}  // namespace segue::task
