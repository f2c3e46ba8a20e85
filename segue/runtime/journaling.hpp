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

/// What the journal is told of a transition.
namespace segue::runtime {

/// The entry of what became of `transition` from `current`; `known` is what the journal knew before
/// (Journal::times()), from which the prediction is made. Actions of `result` beyond those of the transition
/// are of a way that was found instead. Any thread; takes a millisecond for a hundred actions.
journal::TransitionEntry journal_entry(const SwitchResult& result, const model::Network& current,
                                       const model::Transition& transition, const model::ActionTimes& known);

/// The same for a request that came to no transition: refused, superseded.
journal::TransitionEntry journal_entry(const SwitchResult& result);

namespace detail {

/// A runtime's journal. Any thread; nothing blocks.
class JournalKeeper {
 public:
  using Known = std::shared_ptr<const model::ActionTimes>;

  /// Keeps nothing where `path` is empty. Trouble with the file becomes events. `log` must outlive this.
  JournalKeeper(const std::filesystem::path& path, EventLog& log);

  void accepted(std::uint64_t request, const std::string& who, const model::NetworkName& wanted);
  /// `done`: what is done about it, "reported", "repaired" ...
  void differs(const std::string& subject, const std::string& sentence, const std::string& done);
  /// A request that came to no transition.
  void ended(const SwitchResult& result);

  /// What is known before a transition, for ended(); null where nothing is kept.
  [[nodiscard]] Known known() const;
  /// A transition from `current`. Fills in what was predicted of it.
  void ended(SwitchResult& result, const model::Network& current, const model::Transition& transition,
             const Known& known);

 private:
  std::unique_ptr<journal::Journal> journal_;
};

}  // namespace detail

}  // namespace segue::runtime
