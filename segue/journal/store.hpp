// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/journal/database.hpp>
#include <segue/journal/entries.hpp>
#include <segue/model/action_times.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <variant>

/// Entries as rows.
namespace segue::journal::detail {

using Entry = std::variant<TransitionEntry, RequestEntry, DifferenceEntry, GapEntry>;

/// An entry's share of what may wait or be kept.
inline std::size_t weight_of(const Entry& entry) {
  const auto* transition = std::get_if<TransitionEntry>(&entry);
  return transition == nullptr ? 1 : 1 + transition->actions.size();
}

/// The file of a journal, opened for writing. Not thread safe.
class Store {
 public:
  /// Makes the folder and the file where they are missing. ParseError where what is there is damaged;
  /// InvalidArgument and Unsupported as bring_up_to_date().
  static Result<Store> open(const std::filesystem::path& path, std::size_t keep_actions);

  [[nodiscard]] const model::ActionTimes& times() const { return times_; }
  /// Whether the file is still what is found under its path: it may have been removed or exchanged.
  [[nodiscard]] bool is_in_place() const;

  /// All of them or none, and what is learnt from them; then removes what is too old. When it returns they
  /// are on the disk.
  Result<void> write(std::span<const Entry> entries);

 private:
  /// A file, whatever its name.
  struct Identity {
    std::uint64_t device = 0;
    std::uint64_t number = 0;
    friend bool operator==(const Identity&, const Identity&) = default;
  };
  static Identity identify(const std::filesystem::path& path);

  Store(Database database, std::filesystem::path path, std::size_t keep_actions);
  Result<void> insert(std::span<const Entry> entries, model::ActionTimes& times);
  Result<void> insert(const TransitionEntry& entry);
  Result<void> learn(const TransitionEntry& entry, model::ActionTimes& times);
  Result<void> remove_old(std::size_t added);
  Result<void> remove_old_transitions();

  Database database_;
  std::filesystem::path path_;
  Identity identity_;
  std::size_t keep_actions_;
  std::size_t kept_ = 0;  ///< transitions and their actions in the file; others may have added some
  model::ActionTimes times_;
};

}  // namespace segue::journal::detail
