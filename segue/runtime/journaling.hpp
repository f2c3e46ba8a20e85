// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/journal/entries.hpp>
#include <segue/journal/journal.hpp>
#include <segue/model/action_times.hpp>
#include <segue/model/network.hpp>
#include <segue/runtime/event_log.hpp>
#include <segue/runtime/runtime.hpp>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

/// Entries of the journal built from results of the runtime.
namespace segue::runtime {

/// The network that runs, as JSON: {"tasks": [{"id", "component", "state", "host", "process"}],
/// "connections": [{"from", "to"}]}, sorted, so that the same network gives the same text.
std::string network_text(const model::Network& network);

/// The entry of an executed transition from `current`. `known` are the durations known before it
/// (Journal::times()), from which the prediction is computed. Actions of `result` beyond those of
/// `transition` belong to a replanned one. From any thread; takes about a millisecond for a hundred actions.
journal::TransitionEntry journal_entry(const SwitchResult& result, const model::Network& current,
                                       const model::Transition& transition, const model::ActionTimes& known);

/// The entry of a request without a transition: it was refused or superseded.
journal::TransitionEntry journal_entry(const SwitchResult& result);

namespace detail {

/// The journal of a runtime, if it keeps one. All functions may be called from any thread; only flush()
/// blocks.
class JournalKeeper {
 public:
  using Known = std::shared_ptr<const model::ActionTimes>;

  /// Keeps no journal if `path` is empty. Problems with the file become events in `log`, which must outlive
  /// this.
  JournalKeeper(const std::filesystem::path& path, const std::filesystem::path& robot_folder, EventLog& log);

  void accepted(std::uint64_t request, const std::string& who, const model::NetworkName& wanted);
  /// A controller as it was read from a file or sent.
  void loaded(const model::Network& network);
  /// Drift, and how it was handled: "reported", "repaired", "given up".
  void drifted(const std::string& subject, const std::string& sentence, const std::string& done);
  /// An action of a mission that commands the robot.
  void did(journal::MissionEntry entry);
  /// Entries that are not recorded.
  void lost(std::uint64_t entries, const std::string& reason);
  /// The runtime observes the robot from here on.
  void began(const model::Network& observed, const model::NetworkName& controller);
  /// It ends.
  void stopped();
  /// A request without a transition.
  void ended(const SwitchResult& result);

  /// The durations known before a transition, for ended(); null if no journal is kept.
  [[nodiscard]] Known known() const;
  /// The networks that ran before and after a transition, without parts that the host adds.
  struct Ends {
    model::Network before;
    model::Network after;
  };
  /// An executed transition from `current`. Fills in its prediction.
  void ended(SwitchResult& result, const model::Network& current, const model::Transition& transition,
             const Known& known, const Ends& ends);

  /// As Journal::flush(); done where no journal is kept.
  [[nodiscard]] Result<void> flush(TimePoint deadline) const;

 private:
  std::unique_ptr<journal::Journal> journal_;
};

}  // namespace detail

}  // namespace segue::runtime
