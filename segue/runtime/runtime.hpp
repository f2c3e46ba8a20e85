// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/host/task_host.hpp>
#include <segue/journal/entries.hpp>
#include <segue/model/component.hpp>
#include <segue/model/network.hpp>
#include <segue/model/robot.hpp>
#include <segue/model/transition.hpp>
#include <segue/runtime/event.hpp>
#include <segue/solve/solve.hpp>

#include <cstdint>
#include <filesystem>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

/// The runtime (the paper's TaskNetworkHandler) accepts requests, solves and executes transitions, and keeps
/// the belief.
namespace segue::runtime {

enum class Outcome { Done, Superseded, Refused, Failed };
std::string_view to_string(Outcome outcome);

struct ActionRecord {
  model::Action action;
  Duration started{0};             ///< since the begin of the execution
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
  Collect     ///< leftovers are removed; "tidy" in JSON
};
std::string_view to_string(Cause cause);

/// How a transition that failed in prepare or commit was undone.
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
struct SwitchResult {
  Outcome outcome = Outcome::Done;
  Cause cause = Cause::Request;
  std::uint64_t request = 0;  ///< 0: not requested
  std::string who;            ///< sent the request
  std::chrono::system_clock::time_point time;
  model::NetworkName from;
  model::NetworkName to;
  model::NetworkName runs;  ///< the controller that runs now; empty: none with a name
  model::Order order = model::Order::Seamless;
  Duration solve_time{0};
  Duration duration{0};  ///< of the execution, undoing included
  /// Of each phase, from its first to its last action. Control is interrupted in commit only.
  Duration prepare{0};
  Duration commit{0};
  Duration retire{0};
  std::optional<journal::Prediction> predicted;  ///< the prediction, if a journal is kept
  /// If part of the old network could not be taken down as planned, the actions of the replanned transition
  /// follow those of the original one.
  std::vector<ActionRecord> actions;
  std::optional<Error> error;     ///< why it was refused, superseded or failed, and where
  std::optional<Undo> undo;       ///< if it failed
  std::optional<Error> leftover;  ///< Outcome::Done, but part of the old network could not be retired
  Diagnostics diagnostics;        ///< all findings of validation, if refused
};

enum class RuntimeState { Idle, Executing, Failed };
std::string_view to_string(RuntimeState state);

/// A controller by name, a network, or a transition to be applied as it is (the paper's transition request
/// interface).
using Request = std::variant<model::NetworkName, model::Network, model::Transition>;

struct RequestOptions {
  model::Order order = model::Order::Seamless;
  Duration action_deadline = std::chrono::seconds(30);  ///< for each action
  /// Removed processes are killed without stopping their tasks first (solve::Options::force).
  bool force = false;
  std::string who;  ///< the sender, for the journal
};

struct RuntimeOptions {
  /// The controller to switch to if a failed transition cannot be undone; nothing: keep what then runs.
  std::optional<model::NetworkName> fallback;
  model::Policies policies;       ///< for faults of the running controller
  model::LookAhead look_ahead;    ///< resource limits of standby controllers
  std::filesystem::path journal;  ///< the journal file (journal/journal.hpp); empty: none is kept
};

/// How far a standby controller is prepared.
struct Readiness {
  model::NetworkName controller;
  bool ready = false;        ///< prepared as far as the running controller permits
  std::size_t prepared = 0;  ///< number of its tasks that are configured, running ones included
  std::size_t tasks = 0;
  std::string reason;  ///< why it is not ready
};

/// Owns a thread that executes requests sequentially. A newer request supersedes one that waits and one whose
/// transition is still in its prepare phase; a commit phase is finished first. All functions may be called
/// from any thread and do not block unless stated.
class Runtime {
 public:
  /// `host` and `catalog` must outlive this. The initial belief is a snapshot of `host`.
  Runtime(std::string name, host::TaskHost& host, const model::ComponentCatalog& catalog,
          RuntimeOptions options = {});
  /// Blocks until the actions in progress have ended; leaves the tasks as they are.
  ~Runtime();
  Runtime(const Runtime&) = delete;
  Runtime& operator=(const Runtime&) = delete;

  [[nodiscard]] const std::string& name() const;

  /// Adds or replaces a controller that can be requested by name. An invalid network is not added; the result
  /// lists all problems.
  Diagnostics add_controller(model::Network network);
  [[nodiscard]] std::vector<model::NetworkName> controllers() const;
  [[nodiscard]] std::optional<model::Network> controller(const model::NetworkName& name) const;

  /// Requests a network; the future gets the result. Validation and solving precede any action.
  std::future<SwitchResult> request(Request request, RequestOptions options = {});
  /// Calls request() and waits for the result. Blocks.
  SwitchResult switch_to(Request request, RequestOptions options = {});
  /// The transition that request() would execute now.
  Result<model::Transition> plan(const Request& request, RequestOptions options = {}) const;

  [[nodiscard]] RuntimeState state() const;
  /// The network believed to be running; before the first request its name is "".
  [[nodiscard]] model::Network belief() const;
  /// Replaces the belief by `network`, or by a snapshot of the host (the paper's reset_belief). During a
  /// transition the reset is postponed to its end; the call does not block. A request starts from a snapshot
  /// of the host, except the first one after a belief was given: that starts from the given network.
  void reset_belief(std::optional<model::Network> network = std::nullopt);
  /// Prepares these controllers and keeps them on standby, the likeliest first, as far as the running
  /// controller and the budget permit. Replaces the list of an earlier call. A request for a ready controller
  /// begins with its commit phase. The future gets one entry for each controller once done; requests take
  /// precedence.
  std::future<std::vector<Readiness>> prepare(std::vector<model::NetworkName> controllers);
  /// The readiness of the standby controllers after the last preparation.
  [[nodiscard]] std::vector<Readiness> readiness() const;

  /// Drift: the differences between the observed and the desired network, as sentences. Empty during a
  /// transition. Blocks while the host takes a snapshot.
  [[nodiscard]] std::vector<std::string> observed_differences() const;

  /// Processes of the running controller that have ended and are still missing: why, and the last lines of
  /// their logs.
  [[nodiscard]] std::map<model::DeploymentKey, std::string> ended_processes() const;
  /// Faults and leftovers that lasted longer than the policies permit attempts, as sentences. From the last
  /// supervision.
  [[nodiscard]] std::vector<std::string> unresolved() const;

  /// Finished requests, oldest first; the last hundred are kept.
  [[nodiscard]] std::vector<SwitchResult> history() const;
  /// Events after `after`, oldest first. Blocks until there is one, at most for `wait`.
  [[nodiscard]] std::vector<Event> events(std::uint64_t after = 0, Duration wait = {}) const;

  [[nodiscard]] host::TaskHost& host();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::runtime
