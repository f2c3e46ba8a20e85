// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/action.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::mission {

/// The global variables of a run: a handle, whose copies are the same variables and may outlive the run.
/// Thread safe; values are copied in and out. A variable keeps the type of its declaration, and one without
/// declaration that which it was made with.
class Globals {
 public:
  /// What lock() gave; only its holder may write a locked variable.
  using Key = std::uint64_t;

  explicit Globals(const std::vector<Port>& declared = {});

  [[nodiscard]] std::optional<type::Value> get(std::string_view name) const;
  /// TypeMismatch; PermissionDenied where the variable is locked and `key` is not its key. A variable that is
  /// not there is made, of type `type` or else of that of the value.
  Result<void> set(const std::string& name, type::Value value, Key key = 0, std::string_view type = {});
  /// PermissionDenied where it is locked. Deleting what is not there is no error.
  Result<void> erase(const std::string& name);

  /// Waits until nobody holds the lock, for `timeout` of real time at the most: DeadlineExceeded. A variable
  /// that is not there is made, empty.
  Result<Key> lock(const std::string& name, Duration timeout);
  /// PermissionDenied where `key` is not that of the lock; `force` takes it from whoever holds it.
  Result<void> unlock(const std::string& name, Key key, bool force = false);
  /// Whether somebody holds the lock who has another key.
  [[nodiscard]] bool is_locked(std::string_view name, Key key = 0) const;

  /// All, by name.
  [[nodiscard]] type::Value snapshot() const;

 private:
  struct Variables;
  std::shared_ptr<Variables> variables_;
};

}  // namespace segue::mission
