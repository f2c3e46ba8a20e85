// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/mission/execution.hpp>
#include <segue/mission/mission.hpp>
#include <segue/mission/program.hpp>
#include <segue/mission/units.hpp>
#include <segue/mission_engine/run_journal_file.hpp>
#include <segue/mission_engine/under_way.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace segue::mission {

/// Counts as a map, as journals have them: the count by the number of the state; entries that are not numbers
/// are left out.
type::Value to_value(const std::map<StateIndex, std::uint32_t>& counts);
std::map<StateIndex, std::uint32_t> counts_by_state(const type::ValueMap& map);

/// A file that records a run: a line of JSON for each action that begins and for each that ends. A later run
/// of the same mission replays the recorded ends in their order (concurrently: as actions get their turn)
/// instead of executing these actions, and so gets to the point at which the earlier run was interrupted. For
/// one thread, but for progressed().
///
/// A potentially irreversible action is recorded, and the record synced to disk, before it begins. Where the
/// file cannot be written the run continues, and the file says what it lacks (RunJournalFile), so that no
/// such action is executed twice unless somebody says so. NaN and infinities, which JSON lacks, become null.
class RunJournal {
 public:
  /// The parameters of the run.
  struct Start {
    type::ValueMap inputs;
    std::vector<std::string> facts;
    std::string start_at;
    bool concurrent = false;  ///< of a concurrent run, which can only be resumed concurrently
    UnitCounts resources{};   ///< units in place of those that the mission declares
    std::uint64_t seed = 0;   ///< varies simulated durations
  };
  /// Asked with GoOn: whether an action can go on from its recorded progress (null: it had commanded nothing
  /// yet).
  using CanGoOn = std::function<Result<void>(const Action& action, const type::Value& progress)>;
  struct End {
    Outcome outcome = 0;
    std::string error;
    bool preempted = false;
    std::vector<type::Value> outputs;
    type::ValueMap globals;           ///< variables that were set
    std::vector<std::string> erased;  ///< names of variables
    /// The facts that an opaque subtree made true, and with "!" those that it made false.
    std::vector<std::string> facts{};
    UnitChanges units{};  ///< of an opaque subtree: units that it has created or removed
    /// How often states in an opaque subtree have begun since the mission began.
    std::map<StateIndex, std::uint32_t> begun{};
    type::ValueMap values{};  ///< of the world, that an opaque subtree may have changed
  };
  using Warn = std::function<void(std::string)>;

  /// AlreadyExists if the file exists, IoError, PermissionDenied.
  static Result<std::unique_ptr<RunJournal>> create(const std::filesystem::path& file, const Mission& mission,
                                                    Start start, Warn warn = {});
  /// NotFound; ParseError if it is not a journal, or a damaged one; InvalidArgument if it is that of another
  /// mission or, with another `concurrent`, of another kind of run; InvalidState if that run has ended, if
  /// another process writes the file, and with Refuse if actions were running, which it names. A damaged end
  /// is cut off, and `warn` told, where nothing that may not be repeated can have been recorded there.
  static Result<std::unique_ptr<RunJournal>> resume(const std::filesystem::path& file, const Mission& mission,
                                                    bool concurrent, UnderWay under_way,
                                                    const Warn& warn = {}, const CanGoOn& can_go_on = {});

  [[nodiscard]] const Start& start() const { return start_; }
  /// How many actions had ended in the earlier run.
  [[nodiscard]] std::size_t size() const { return ends_.size(); }

  /// The position of the end of this execution.
  [[nodiscard]] std::optional<std::size_t> find(const Execution& execution) const;
  [[nodiscard]] const End& operator[](std::size_t place) const { return ends_[place]; }
  /// How an execution of a potentially irreversible action that was running is taken to have ended; nothing
  /// if it was not running, or is to be executed again.
  [[nodiscard]] std::optional<End> assumed_end(const Execution& execution, const Action& action) const;

  /// The executions that had ended in the earlier run.
  [[nodiscard]] std::set<Execution> executions() const;
  /// The states that had ended their preemptive containers first in the earlier run (concurrent runs).
  [[nodiscard]] const std::set<Execution>& firsts() const { return firsts_; }

  void began(const Execution& execution, bool irreversible, std::string_view action = {});
  /// How far the execution has got, in place of what was recorded before; on disk when this returns. From any
  /// thread.
  void progressed(const Execution& execution, const type::Value& progress);
  /// How far it had got in the earlier run, if it goes on; else null.
  [[nodiscard]] const type::Value& progress(const Execution& execution) const;
  void ended(const Execution& execution, const End& end);
  /// `globals`: all variables, by name, of which those that have changed since the last call belong to `end`.
  void ended(const Execution& execution, End end, const type::Value& globals);
  /// The state has ended its preemptive container.
  void first(const Execution& execution);
  void finished(const std::string& outcome);
  /// The run is being stopped: actions that end from now on were preempted and are not recorded, so that a
  /// later run executes them.
  void close();
  [[nodiscard]] bool is_closed() const { return is_closed_; }
  /// A name that no other run has.
  [[nodiscard]] std::string run() const { return file_->run(); }

 private:
  explicit RunJournal(std::unique_ptr<RunJournalFile> file) : file_(std::move(file)) {}
  Result<void> read(const RunJournalFile::Contents& contents, const Mission& mission);
  Result<void> take(const type::Value& line);
  /// An action that had begun and not ended.
  struct Open {
    bool irreversible = false;
    std::string action{};
    type::Value progress{};
  };
  [[nodiscard]] std::string open_actions() const;
  [[nodiscard]] std::string known_text() const;
  Result<void> go_on(const Mission& mission, const CanGoOn& can_go_on);

  const std::unique_ptr<RunJournalFile> file_;  ///< which progress is written to from any thread
  Start start_;
  UnderWay under_way_ = UnderWay::Refuse;
  std::vector<End> ends_;
  std::map<Execution, std::size_t> places_;
  std::map<Execution, Open> open_;
  std::set<Execution> firsts_;
  bool finished_ = false;
  bool is_closed_ = false;
  type::Value globals_;  ///< as recorded last
};

}  // namespace segue::mission
