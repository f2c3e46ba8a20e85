// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/model/transition.hpp>
#include <segue/runtime/network_parts.hpp>

#include <functional>
#include <utility>
#include <vector>

namespace segue::runtime::detail {

/// Actions that are in progress although their transition has ended, since it had to make way. Thread safe;
/// nothing blocks.
class LeftActions {
 public:
  /// `changed` is called, without a lock that others need, when one has ended.
  explicit LeftActions(std::function<void()> changed) : changed_(std::move(changed)) {}
  /// `changed` is not called any more.
  void close();

  void add(const model::Action& action);
  void ended(const model::Action& action);
  [[nodiscard]] bool any() const;
  /// Whether one of them is about these.
  [[nodiscard]] bool concern(const NetworkParts& parts) const;
  /// The observed network without processes that begin or end: nothing can be done with them meanwhile.
  [[nodiscard]] model::Network without_their_processes(model::Network observed) const;

 private:
  mutable Mutex mutex_;  ///< protects the next one
  std::vector<model::Action> actions_ SEGUE_GUARDED_BY(mutex_);
  Mutex changed_mutex_;  ///< protects the next one, also while it is called
  std::function<void()> changed_ SEGUE_GUARDED_BY(changed_mutex_);
};

}  // namespace segue::runtime::detail
