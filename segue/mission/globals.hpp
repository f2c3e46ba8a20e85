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

/// The global variables of a run. A handle: copies refer to the same variables and may outlive the run.
/// Thread safe; values are copied in and out. A variable keeps its declared type, or without a declaration
/// the type with which it was created.
class Globals {
 public:
  /// Returned by lock(); only its holder may write a locked variable.
  using Key = std::uint64_t;

  explicit Globals(const std::vector<Port>& declared = {});

  [[nodiscard]] std::optional<type::Value> get(std::string_view name) const;
  /// TypeMismatch; PermissionDenied if the variable is locked and `key` is not its key. A missing variable is
  /// created, of type `type` or else of the type of the value.
  Result<void> set(const std::string& name, type::Value value, Key key = 0, std::string_view type = {});
  /// PermissionDenied if it is locked. Erasing a missing variable is no error.
  Result<void> erase(const std::string& name);

  /// Blocks until the lock is free, for at most `timeout` of real time; then DeadlineExceeded. A missing
  /// variable is created without a value.
  Result<Key> lock(const std::string& name, Duration timeout);
  /// PermissionDenied if `key` is not that of the lock, unless `force` is set.
  Result<void> unlock(const std::string& name, Key key, bool force = false);
  /// Whether the lock is held with another key.
  [[nodiscard]] bool is_locked(std::string_view name, Key key = 0) const;

  /// All variables, by name.
  [[nodiscard]] type::Value snapshot() const;

 private:
  struct Variables;
  std::shared_ptr<Variables> variables_;
};

}  // namespace segue::mission
