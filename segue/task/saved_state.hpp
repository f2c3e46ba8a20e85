// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <cstdint>
#include <string>

namespace segue::task {

/// The state of a task, for the one that takes over its work. A plain value that can be sent to other
/// processes and computers.
struct SavedState {
  std::string name;           ///< usually the name of its type: "/demo/FilterState"
  std::uint32_t version = 1;  ///< increased when its meaning changes
  type::Value value;
  friend bool operator==(const SavedState&, const SavedState&) = default;
};

}  // namespace segue::task
