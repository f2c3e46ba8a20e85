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

/// `$XDG_STATE_HOME/segue/ROBOT/journal.sqlite`, else `~/.local/state/segue/...`. InvalidArgument where the
/// name is no identifier; NotFound where neither variable is set. Nothing is made.
Result<std::filesystem::path> default_path(std::string_view robot);

struct JournalOptions {
  /// Oldest transitions are removed where there are more actions than this, requests, differences and gaps
  /// where there are more than a tenth of it. A file of a hundred thousand actions has some 20 MB.
  std::size_t keep_actions = 100'000;
  /// Actions and other entries that wait to be written, while they cannot be: the oldest are given up.
  std::size_t queue = 20'000;
};

/// What people should hear about the file. Each state is told once, not each attempt.
struct Trouble {
  enum class Kind {
    Unwritable,  ///< cannot be written now; tried again
    Refused,     ///< of a newer Segue or something else; never touched
    Replaced,    ///< was damaged; moved aside and begun anew
    Resumed      ///< is written again
  };
  Kind kind = Kind::Unwritable;
  std::string message;     ///< a sentence with the path and what to do
  std::uint64_t lost = 0;  ///< Resumed: entries that were given up meanwhile
};

/// Keeps what a robot does in an SQLite file, written by a thread of its own: whoever adds an entry neither
/// waits for the disk nor hears of its failure. Any number of readers (JournalReader) may look at the file
/// meanwhile, from other processes too.
///
/// What flush() has confirmed survives the end of the process at any moment, and of the computer. While the
/// file cannot be written, entries wait (JournalOptions::queue) and attempts are repeated, up to 30 s apart;
/// what had to be given up is counted and kept as a GapEntry. All functions may be called from any thread.
class Journal {
 public:
  /// Called from the journal's thread; must not call the journal.
  using OnTrouble = std::function<void(const Trouble&)>;

  /// Makes the file and its folders where they are missing. Waits for the first attempt, two seconds at
  /// most; what goes wrong is told and tried again.
  explicit Journal(const std::filesystem::path& path, const JournalOptions& options = {},
                   OnTrouble on_trouble = {});
  /// Writes what waits, if one attempt does it.
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const;

  void add(TransitionEntry entry);
  void add(RequestEntry entry);
  void add(DifferenceEntry entry);

  /// What was learnt from all transitions in the file; never null. A transition counts once it is written.
  [[nodiscard]] std::shared_ptr<const model::ActionTimes> times() const;

  /// Tries at once to write all that was added before. The error is why it is not written: of the file, or
  /// DeadlineExceeded. Blocks.
  Result<void> flush(TimePoint deadline);

  /// Entries given up since this began.
  [[nodiscard]] std::uint64_t lost() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::journal
