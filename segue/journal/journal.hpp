// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/journal/entries.hpp>
#include <segue/model/action_times.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace segue::journal {

/// `$XDG_STATE_HOME/segue/ROBOT/journal.sqlite`, else `~/.local/state/segue/...`. InvalidArgument if the name
/// is not a valid identifier, NotFound if neither variable is set. Does not create anything.
Result<std::filesystem::path> default_path(std::string_view robot);

/// How much a journal keeps, and of which robot it is.
struct JournalOptions {
  /// The oldest transitions are removed once there are more actions than this; entries of any other kind once
  /// there are more than a tenth of it. A file of a hundred thousand actions has about 20 MB.
  std::size_t keep_actions = 100'000;
  /// Limit on the actions and other entries that wait to be written. Beyond it the oldest are dropped.
  std::size_t queue = 20'000;
  /// Durations are learned for each folder of a robot apart, since robots of one name share the file. Empty:
  /// the robot is made of no files.
  std::filesystem::path robot_folder{};
};

/// A problem with the file that users should see. Reported once per change of state, not for each attempt.
struct Trouble {
  enum class Kind {
    Unwritable,  ///< cannot be written now; will be tried again
    Refused,     ///< belongs to a newer Segue or another program; is never changed
    Replaced,    ///< was damaged; has been renamed, and a new file created
    Resumed      ///< can be written again
  };
  Kind kind = Kind::Unwritable;
  std::string message;     ///< a sentence with the path and what to do
  std::uint64_t lost = 0;  ///< Resumed: number of entries dropped meanwhile
};

/// Writes the entries of a robot to an SQLite file in a thread of its own. Adding an entry neither waits for
/// the disk nor fails. Any number of readers (JournalReader) may read the file meanwhile, also from other
/// processes.
///
/// Entries confirmed by flush() survive a crash of the process or the computer. While the file cannot be
/// written, entries wait (JournalOptions::queue) and attempts are repeated up to 30 s apart; dropped entries
/// are counted and recorded as a GapEntry. All functions may be called from any thread.
class Journal {
 public:
  /// Called from the journal's thread; must not call the journal.
  using OnTrouble = std::function<void(const Trouble&)>;

  /// Creates the file and its folders if they are missing. Blocks for the first attempt, at most two seconds;
  /// failures are reported and tried again.
  explicit Journal(const std::filesystem::path& path, const JournalOptions& options = {},
                   OnTrouble on_trouble = {});
  /// Makes one attempt to write the waiting entries. Blocks.
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const;

  void add(TransitionEntry entry);
  void add(RequestEntry entry);
  void add(DifferenceEntry entry);
  void add(VersionEntry entry);
  void add(MissionEntry entry);
  void add(RunningEntry entry);
  /// Adds a gap: entries that were lost before they came here.
  void add(GapEntry entry);

  /// The statistics of all transitions of the robot's folder written so far, removed ones included; never
  /// null.
  [[nodiscard]] std::shared_ptr<const model::ActionTimes> times() const;

  /// Writes all entries added before. Fails with the error of the file, or DeadlineExceeded. Blocks.
  Result<void> flush(Deadline deadline);

  /// Number of entries dropped since construction.
  [[nodiscard]] std::uint64_t lost() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::journal
