// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/journal/database.hpp>
#include <segue/journal/entries.hpp>
#include <segue/journal/journal.hpp>
#include <segue/model/action_times.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <variant>

/// Writes entries to the tables of the file.
namespace segue::journal::detail {

using AnyEntry = std::variant<TransitionEntry, RequestEntry, DifferenceEntry, VersionEntry, MissionEntry,
                              RunningEntry, GapEntry>;

/// The number of rows of an entry, which limits count.
inline std::size_t weight_of(const AnyEntry& entry) {
  const auto* transition = std::get_if<TransitionEntry>(&entry);
  return transition == nullptr ? 1 : 1 + transition->actions.size() + transition->undo_actions.size();
}

/// The file of a journal, opened for writing. Not thread safe.
class Store {
 public:
  /// Creates the folder and the file if they are missing. ParseError if the file is damaged; InvalidArgument
  /// and Unsupported as bring_up_to_date().
  static Result<Store> open(const std::filesystem::path& path, const JournalOptions& options);

  [[nodiscard]] const model::ActionTimes& times() const { return times_; }
  /// Whether the path still refers to the opened file: it may have been removed or replaced.
  [[nodiscard]] bool is_in_place() const;

  /// Writes all entries or none, adds their duration samples, and removes entries that are too old. On return
  /// they are on the disk.
  Result<void> write(std::span<const AnyEntry> entries);

 private:
  /// Identity of a file, independent of its name.
  struct Identity {
    std::uint64_t device = 0;
    std::uint64_t number = 0;
    friend bool operator==(const Identity&, const Identity&) = default;
  };
  static Identity identify(const std::filesystem::path& path);

  Store(Database database, std::filesystem::path path, const JournalOptions& options);
  Result<void> insert(std::span<const AnyEntry> entries, model::ActionTimes& times);
  Result<void> learn(const TransitionEntry& entry, model::ActionTimes& times);
  Result<void> remove_old(std::size_t added);
  Result<void> remove_old_transitions();

  Database database_;
  std::filesystem::path path_;
  Identity identity_;
  std::size_t keep_actions_;
  std::string folder_;  ///< of the robot
  std::size_t kept_ =
      0;  ///< number of transitions and actions in the file; other writers may have added some
  model::ActionTimes times_;
};

}  // namespace segue::journal::detail
