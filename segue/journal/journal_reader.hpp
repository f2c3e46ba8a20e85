// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/journal/entries.hpp>
#include <segue/model/action_times.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace segue::journal {

/// Reads a journal file, also while a robot writes it, and never changes it. Invalid rows (written by another
/// program) are skipped and counted. Not thread safe; functions block.
class JournalReader {
 public:
  /// NotFound if there is no file, InvalidArgument if it is not a journal, Unsupported if a newer Segue wrote
  /// it, ParseError if it is damaged.
  static Result<JournalReader> open(const std::filesystem::path& path);
  JournalReader(JournalReader&&) noexcept;
  JournalReader& operator=(JournalReader&&) noexcept;
  ~JournalReader();

  enum class Actions { With, Without };
  /// The latest `limit` entries, oldest first.
  Result<std::vector<TransitionEntry>> transitions(std::size_t limit, Actions actions = Actions::With);
  Result<std::vector<RequestEntry>> requests(std::size_t limit);
  Result<std::vector<DifferenceEntry>> differences(std::size_t limit);
  Result<std::vector<VersionEntry>> versions(std::size_t limit);
  Result<std::vector<MissionEntry>> missions(std::size_t limit);
  Result<std::vector<GapEntry>> gaps(std::size_t limit);
  /// The learned times of the robot folder that learned last.
  Result<model::ActionTimes> times();
  /// The learned times of the robot folder that the file is in, or is; of the folder that learned last, if it
  /// is in none.
  Result<model::ActionTimes> times_near(const std::filesystem::path& file);

  /// Checks every page and row. ParseError names the first damage.
  Result<void> check();
  /// Number of rows skipped so far.
  [[nodiscard]] std::uint64_t invalid_rows() const;

 private:
  struct Implementation;
  explicit JournalReader(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::journal
