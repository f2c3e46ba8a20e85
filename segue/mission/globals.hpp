// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/action.hpp>
#include <segue/type/value.hpp>

#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::mission {

/// The global variables of a run. Thread safe; values are copied in and out. A variable keeps the type of its
/// declaration, and one without declaration that of its first value.
class Globals {
 public:
  /// What lock() gave; only its holder may write a locked variable.
  using Key = std::uint64_t;

  explicit Globals(const std::vector<Port>& declared = {});

  [[nodiscard]] std::optional<type::Value> get(std::string_view name) const;
  /// TypeMismatch; PermissionDenied where the variable is locked and `key` is not its key.
  Result<void> set(const std::string& name, type::Value value, Key key = 0);
  /// PermissionDenied where it is locked. Deleting what is not there is no error.
  Result<void> erase(const std::string& name);

  /// Waits until nobody holds the lock, for `timeout` of real time at the most: DeadlineExceeded. A variable
  /// that is not there is made, empty.
  Result<Key> lock(const std::string& name, Duration timeout);
  /// PermissionDenied where `key` is not that of the lock; `force` takes it from whoever holds it.
  Result<void> unlock(const std::string& name, Key key, bool force = false);

  /// All, by name.
  [[nodiscard]] type::Value snapshot() const;

 private:
  struct Variable {
    type::Value value;
    std::string type = "any";
    Key holder = 0;
  };

  mutable std::mutex mutex_;
  std::condition_variable unlocked_;
  std::map<std::string, Variable, std::less<>> variables_;
  Key last_key_ = 0;
};

}  // namespace segue::mission
