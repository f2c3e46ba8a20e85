// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/pending_changes.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/action.hpp>
#include <segue/mission/place.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace segue::mission {

/// The content of a variable that is not a value: something that only its maker can use, such as an object of
/// a Python process. It ends with the last variable, copy or version that refers to it. Thread safe.
class GlobalObject {
 public:
  GlobalObject() = default;
  virtual ~GlobalObject() = default;
  GlobalObject(const GlobalObject&) = delete;
  GlobalObject& operator=(const GlobalObject&) = delete;
  /// The content that everybody else sees: a copy, or a text that describes it.
  [[nodiscard]] virtual type::Value shown() const = 0;
};

/// The value of a variable, or what it holds in place of one, with what that shows.
struct GlobalContent {
  type::Value value;
  std::shared_ptr<const GlobalObject> object;  ///< null: a value
};

/// The global variables of a run. A handle: copies refer to the same variables and may outlive the run.
/// Thread safe; values are copied in and out. A variable keeps its declared type, or without a declaration
/// the type with which it was created.
class Globals {
 public:
  /// Returned by lock(); only its holder may write a locked variable.
  using Key = std::uint64_t;

  explicit Globals(const std::vector<Port>& declared = {});

  /// The value, or what an object shows.
  [[nodiscard]] std::optional<type::Value> get(std::string_view name) const;
  [[nodiscard]] std::optional<GlobalContent> content(std::string_view name) const;
  /// TypeMismatch; PermissionDenied if the variable is locked and `key` is not its key. A missing variable is
  /// created, of type `type` or else of the type of the value.
  Result<void> set(const std::string& name, type::Value value, Key key = 0, std::string_view type = {});
  /// Sets the variable to an object of type `kind`. Fails and creates variables like set().
  Result<void> set_object(const std::string& name, std::shared_ptr<const GlobalObject> object,
                          std::string_view kind, Key key = 0, std::string_view type = {});
  /// PermissionDenied if it is locked. Erasing a missing variable is not an error.
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
  [[nodiscard]] std::vector<std::pair<std::string, GlobalContent>> contents() const;

  // For concurrent runs, where actions do not begin and end in program order.

  /// A handle for an execution that is certain to count: it uses the variables at once, and remembers where.
  [[nodiscard]] Globals at(Place place) const;
  /// A handle for an execution that may be discarded: it sees what actions before `place` have written and
  /// what it has written itself. See pending_changes().
  [[nodiscard]] Globals kept_aside_at(Place place) const;
  /// The variables that were used through this handle; null unless it was made by kept_aside_at().
  [[nodiscard]] std::shared_ptr<PendingChanges> pending_changes() const;
  struct Changes {
    type::ValueMap set;
    std::vector<std::string> erased;
  };
  /// The changes that were made through a handle of at() or kept_aside_at(), with the last values.
  [[nodiscard]] Changes changes() const;
  /// The execution has ended: a handle made by kept_aside_at() changes nothing any more (InvalidState).
  void close();
  /// All actions before this position have ended.
  void settle_before(std::uint64_t position);

 private:
  struct Content;
  struct Variable;
  struct Version;
  struct Entry;
  struct Variables;
  struct View;
  class Pending;

  [[nodiscard]] Variable find(std::string_view name) const;
  Result<void> put(const std::string& name, Variable variable);
  Result<void> set(const std::string& name, Content content, Key key, const std::string& kind);

  std::shared_ptr<Variables> variables_;
  std::shared_ptr<View> view_;  ///< null: neither at() nor kept_aside_at()
};

}  // namespace segue::mission
