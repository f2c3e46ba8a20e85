// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/base/error.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::mission {

/// The file of a RunJournal. Its first line says which run it is, its second one up to which entry it had
/// been synced to disk, and each further line is an entry. All are JSON and end with their checksums; entries
/// have numbers and the checksum of the line before, so that it is seen where some were changed, lost,
/// repeated, or come from another file.
///
/// An entry that cannot be written is kept and written with the next one; `tell` is called when the file
/// falls behind, and when it has all again. The second line is overwritten in place, which a full disk
/// permits: what a durable entry announces may be done although the entry itself is not in the file, since
/// the file says that it lacks it. Where even that cannot be written, the file is emptied. For any thread.
class RunJournalFile {
 public:
  using Tell = std::function<void(std::string)>;

  /// The content of a file that is to be continued.
  struct Contents {
    type::Value first;                 ///< the first line
    std::vector<type::Value> entries;  ///< those that are there, up to the first that is damaged or missing
    /// Why the run must not be continued: something is damaged before the end, or something is missing that
    /// had been synced.
    std::optional<std::string> refusal{};
    std::size_t cut = 0;  ///< damaged lines at the end, which continue_after_contents() cuts off
  };

  /// AlreadyExists, IoError, PermissionDenied. `first` is on disk when this returns.
  static Result<std::unique_ptr<RunJournalFile>> create(const std::filesystem::path& path,
                                                        const type::ValueMap& first, Tell tell);
  /// NotFound, PermissionDenied, InvalidState if another process writes the file; ParseError if it is no such
  /// file, or one of a version that cannot be read.
  static Result<std::unique_ptr<RunJournalFile>> open(const std::filesystem::path& path, Tell tell);

  /// The content of the file that was opened; to be called once.
  [[nodiscard]] Contents take_contents();
  /// Cuts a damaged end off; entries can be added from then on.
  Result<void> continue_after_contents();

  /// A name that no other file has.
  [[nodiscard]] std::string run();
  /// `durable`: on disk when this returns, or known to be missing.
  void add(const type::ValueMap& entry, bool durable);
  /// Nothing is added any more.
  void close();

  RunJournalFile(const RunJournalFile&) = delete;
  RunJournalFile& operator=(const RunJournalFile&) = delete;
  ~RunJournalFile() { close(); }

 private:
  RunJournalFile(Descriptor file, Tell tell) : file_(std::move(file)), tell_(std::move(tell)) {}
  Result<void> read(std::string_view text) SEGUE_REQUIRES(mutex_);
  void read_entries(std::string_view text) SEGUE_REQUIRES(mutex_);
  [[nodiscard]] std::string second_line() const SEGUE_REQUIRES(mutex_);
  bool write_pending() SEGUE_REQUIRES(mutex_);
  bool write_synced() SEGUE_REQUIRES(mutex_);
  void fell_behind(int reason) SEGUE_REQUIRES(mutex_);
  void give_up(int reason) SEGUE_REQUIRES(mutex_);

  Mutex mutex_;  ///< protects all below
  Descriptor file_ SEGUE_GUARDED_BY(mutex_);
  const Tell tell_;
  Contents contents_ SEGUE_GUARDED_BY(mutex_);
  std::uint64_t run_ SEGUE_GUARDED_BY(mutex_) = 0;      ///< the checksum of the first line
  std::uint64_t last_ SEGUE_GUARDED_BY(mutex_) = 0;     ///< the checksum of the last line
  std::uint64_t entries_ SEGUE_GUARDED_BY(mutex_) = 0;  ///< how many there have been
  /// The number of entries that had to be on disk before an action could begin.
  std::uint64_t synced_ SEGUE_GUARDED_BY(mutex_) = 0;
  std::size_t second_at_ SEGUE_GUARDED_BY(mutex_) = 0;  ///< where the second line begins
  std::size_t length_ SEGUE_GUARDED_BY(mutex_) = 0;     ///< up to the end of the last entry that was written
  std::string pending_ SEGUE_GUARDED_BY(mutex_);        ///< entries that could not be written yet
  bool is_behind_ SEGUE_GUARDED_BY(mutex_) = false;     ///< which has been told
};

}  // namespace segue::mission
