// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/mission/globals.hpp>

#include <map>

namespace segue::mission {

struct Globals::Content {
  type::Value value;
  std::string type = "any";
  std::shared_ptr<const GlobalObject> object{};  ///< null: a value

  [[nodiscard]] type::Value shown() const { return object ? object->shown() : value; }
};

/// Cheap to copy. Without content the variable does not exist.
struct Globals::Variable {
  std::shared_ptr<const Content> content;
  Key holder = 0;  ///< of the lock; 0: nobody
};

/// A variable as the write of an action has left it.
struct Globals::Version {
  std::uint64_t position = 0;
  std::shared_ptr<const ParallelBranch> branch;
  std::uint64_t number = 0;  ///< counts all writes of the run
  Variable variable;
};

/// `versions` begins with the first write by a handle that has a place; the first one of them is what the
/// variable was before. `users` are the actions that have used it at once.
struct Globals::Entry {
  Variable now;
  std::vector<Version> versions{};
  std::vector<Place> users{};

  /// The last version by an action before `place`, those in parallel branches aside; null if there is none.
  [[nodiscard]] const Version* before(const Place& place) const;
  /// The variable as an action at `place` sees it, with the writes that actions in parallel branches have
  /// made since.
  [[nodiscard]] Variable seen_from(const Place& place) const;
  /// Drops versions and users that no action from `position` on asks for.
  void settle_before(std::uint64_t position);

 private:
  /// The last of those that count.
  template <class Counts>
  [[nodiscard]] const Version* last_before(std::uint64_t position, const Counts& counts) const;
};

/// The mutex guards everything, also the views.
struct Globals::Variables {
  Mutex mutex;
  ConditionVariable unlocked;
  std::map<std::string, Entry, std::less<>> by_name SEGUE_GUARDED_BY(mutex);
  Key last_key SEGUE_GUARDED_BY(mutex) = 0;
  std::uint64_t last_number SEGUE_GUARDED_BY(mutex) = 0;
  std::uint64_t settled SEGUE_GUARDED_BY(mutex) = 0;

  void write(Entry& entry, const Place* place, Variable variable) SEGUE_REQUIRES(mutex);
};

/// How one execution uses the variables.
struct Globals::View {
  struct Use {
    std::uint64_t version = 0;  ///< the last one by an action before it, parallel branches aside
    Key holder = 0;             ///< that it has seen
    Variable own{};             ///< with kept_aside: as it sees it
    bool changed = false;
  };
  Place place;
  bool kept_aside = false;
  bool closed = false;
  bool all = false;  ///< it has asked which variables there are
  std::map<std::string, Use, std::less<>> uses{};

  Use& use(const Variables& variables, std::string_view name) SEGUE_REQUIRES(variables.mutex);
};

}  // namespace segue::mission
