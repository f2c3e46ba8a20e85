// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/error.hpp>
#include <segue/journal/entries.hpp>
#include <segue/model/ids.hpp>
#include <segue/model/transition.hpp>
#include <segue/runtime/controller_change.hpp>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Results of requests.
namespace segue::runtime {

/// Cancelled: on somebody's request, and undone as where it failed.
enum class Outcome { Done, Superseded, Refused, Failed, Cancelled };
std::string_view to_string(Outcome outcome);

/// How one action of a transition went.
struct ActionRecord {
  model::Action action;
  Duration started{0};             ///< since the begin of the transition
  Duration duration{0};            ///< until its end was reported, waiting for others of its batch included
  std::optional<Error> error;      ///< nothing: succeeded
  bool executed = false;           ///< false: an earlier action failed
  std::optional<Duration> took{};  ///< measured by the process that executed it; at most `duration`
};

/// Why a transition was executed.
enum class Cause {
  Request,    ///< a controller was requested
  Repair,     ///< a part of the running controller failed
  Fallback,   ///< a part failed whose failure policy is `fallback`
  LookAhead,  ///< another controller is prepared for standby
  Collect,    ///< leftovers are removed; "tidy" in JSON
  Apply,      ///< the running controller goes to its version in files that were applied
  Pool        ///< an instance of a pool of processes is started, for the first time or again, or ended
};
std::string_view to_string(Cause cause);

/// How a transition that failed in prepare or commit, or was cancelled, was undone.
struct Undo {
  bool restored = false;                       ///< the old network runs exactly as before
  std::optional<model::NetworkName> fallback;  ///< tried because the old network could not be restored
  bool fell_back = false;                      ///< the fallback runs
  std::vector<ActionRecord> actions;           ///< in the order of their execution
  Duration duration{0};
  std::optional<Error> error;  ///< the first failure while undoing
};

/// The result of a request. `actions` is in the order of the transition; `started` gives the order of
/// execution.
struct [[nodiscard]] SwitchResult {
  [[nodiscard]] bool ok() const { return outcome == Outcome::Done; }
  /// Why it was not done, one or several lines: the error, and all findings where there are several. Empty:
  /// it was done.
  [[nodiscard]] std::string why() const;

  Outcome outcome = Outcome::Done;
  Cause cause = Cause::Request;
  std::uint64_t request = 0;  ///< 0: not requested
  std::string who;            ///< sent the request
  std::chrono::system_clock::time_point time;
  model::NetworkName from;
  model::NetworkName to;
  model::NetworkName runs;  ///< the controller that runs now; empty: none with a name
  /// Their versions (model::Network::version); empty: they have none, or it is not known.
  std::string from_version{};
  std::string to_version{};
  std::string runs_version{};
  model::Order order = model::Order::Seamless;
  Duration solve_time{0};
  Duration duration{0};  ///< of the execution, undoing included
  /// Of each phase, from its first to its last action. Control is interrupted in commit only.
  Duration prepare{0};
  Duration commit{0};
  Duration retire{0};
  std::optional<journal::Prediction> predicted;   ///< the prediction, if a journal is kept
  std::optional<journal::PreparedAhead> ahead{};  ///< Outcome::Done: if it found tasks prepared
  /// If part of the old network could not be taken down as planned, the actions of the replanned transition
  /// follow those of the original one.
  std::vector<ActionRecord> actions;
  std::optional<Error> error;     ///< why it was not done, and where; with all findings of validation
  std::optional<Undo> undo;       ///< if it failed, or was cancelled after it had begun
  std::string cancelled_by{};     ///< Outcome::Cancelled
  std::optional<Error> leftover;  ///< Outcome::Done, but part of the old network could not be retired
};

/// The result of Runtime::apply().
struct [[nodiscard]] ApplyResult {
  [[nodiscard]] bool ok() const { return outcome == Outcome::Done; }
  /// As SwitchResult::why().
  [[nodiscard]] std::string why() const;

  /// Done: the controllers are the new ones, and if one of them runs, it runs in its new version. Refused,
  /// Failed: the controllers are unchanged, and so is what runs (unless `transition` says that it could
  /// not be restored). Superseded: newer files were applied before these took effect.
  Outcome outcome = Outcome::Done;
  std::vector<ControllerChange> changes;   ///< compared with the controllers of before
  std::optional<SwitchResult> transition;  ///< of the running controller, if one was executed or refused
  std::optional<Error> error;              ///< why not Done; with the findings of all networks
};

}  // namespace segue::runtime
