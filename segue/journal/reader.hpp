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

/// Reads a journal file, beside a robot that writes it or without. Never changes it. Rows that make no sense
/// (somebody else wrote them) are left out and counted. Not thread safe; functions block.
class JournalReader {
 public:
  /// NotFound where there is no file; InvalidArgument where it is no journal; Unsupported where a newer Segue
  /// wrote it; ParseError where it is damaged.
  static Result<JournalReader> open(const std::filesystem::path& path);
  JournalReader(JournalReader&&) noexcept;
  JournalReader& operator=(JournalReader&&) noexcept;
  ~JournalReader();

  enum class Actions { With, Without };
  /// The latest `limit` of each, oldest first.
  Result<std::vector<TransitionEntry>> transitions(std::size_t limit, Actions actions = Actions::With);
  Result<std::vector<RequestEntry>> requests(std::size_t limit);
  Result<std::vector<DifferenceEntry>> differences(std::size_t limit);
  Result<std::vector<GapEntry>> gaps(std::size_t limit);
  Result<model::ActionTimes> times();

  /// Looks at every page and row. ParseError says what is damaged first.
  Result<void> check();
  /// Rows left out so far.
  [[nodiscard]] std::uint64_t invalid_rows() const;

 private:
  struct Implementation;
  explicit JournalReader(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::journal
