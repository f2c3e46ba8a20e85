// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/type/value.hpp>

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

namespace ros2 {

/// The values that parameters of nodes had before tasks of this process set them, as long as any task does:
/// several tasks may stand for one node, as while a switch exchanges one for another. Any thread.
class FoundParameters {
 public:
  /// Of a node ("/talker").
  using Name = std::pair<std::string, std::string>;

  static FoundParameters& of_this_process();

  [[nodiscard]] bool knows(const Name& parameter) const;
  /// `task` is going to set it. `found`: its rcl_interfaces/msg/ParameterValue; null: not known. The first
  /// one stays, until nobody sets the parameter any more.
  void note(const void* task, const Name& parameter, segue::type::Value found);
  /// The value that it had; nothing where that is not known, and where another task than this one sets it,
  /// too.
  [[nodiscard]] std::optional<segue::type::Value> find(const void* task, const Name& parameter) const;
  /// `task` sets it no longer.
  void let_go(const void* task, const Name& parameter);

 private:
  struct Found {
    segue::type::Value value;
    std::set<const void*> tasks{};
  };
  mutable segue::Mutex mutex_;
  std::map<Name, Found> all_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace ros2
