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
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

/// The runtime (the paper's TaskNetworkHandler): accepts requests, solves, executes, keeps the belief.
namespace segue::runtime {

enum class Outcome { Done, Superseded, Refused, Failed };
std::string_view to_string(Outcome outcome);

struct ActionRecord {
  model::Action action;
  Duration started{0};         ///< since the begin of the execution
  Duration duration{0};        ///< until its end was known, with all that it waited for others of its batch
  std::optional<Error> error;  ///< nothing: done
  bool executed = false;       ///< false: an earlier action failed
  std::optional<Duration> took{};  ///< itself, where it was carried out; `duration` at most
};

/// Why there was a transition.
enum class Cause {
  Request,    ///< somebody asked for a controller
  Repair,     ///< something of the controller failed by itself
  Fallback,   ///< something failed whose policy is the fallback network
  LookAhead,  ///< another controller is kept ready
  Tidy        ///< something was left over
};
std::string_view to_string(Cause cause);

/// How a transition that failed in prepare or commit was undone.
struct Undo {
  bool restored = false;                       ///< all that ran before runs, exactly as it did
  std::optional<model::NetworkName> fallback;  ///< tried, since that could not be restored
  bool fell_back = false;                      ///< and runs
  std::vector<ActionRecord> actions;           ///< in the order of their execution
  Duration duration{0};
  std::optional<Error> error;  ///< what failed on the way back
};

/// What became of a request. Times are wall-clock; actions are in the order of the transition, `started`
/// tells the order of execution.
struct SwitchResult {
  Outcome outcome = Outcome::Done;
  Cause cause = Cause::Request;
  std::uint64_t request = 0;  ///< 0: nobody's request
  std::string who;            ///< asked
  std::chrono::system_clock::time_point time;
  model::NetworkName from;
  model::NetworkName to;
  model::NetworkName runs;  ///< what the robot runs now; empty: nothing that has a name
  model::Order order = model::Order::Seamless;
  Duration solve_time{0};
  Duration duration{0};  ///< of the execution, with what was undone
  /// Of each phase, from its first to its last action. Control is interrupted in commit only.
  Duration prepare{0};
  Duration commit{0};
  Duration retire{0};
  std::optional<journal::Prediction> predicted;  ///< what was expected, where a journal is kept
  /// Where the old network did not let itself be taken down as planned, the actions of the way that was found
  /// instead follow those of the transition.
  std::vector<ActionRecord> actions;
  std::optional<Error> error;     ///< why refused, superseded or failed, and where
  std::optional<Undo> undo;       ///< where it failed
  std::optional<Error> leftover;  ///< done, but not all that is gone could be retired
  Diagnostics diagnostics;        ///< all findings of validation, where refused
};

enum class RuntimeState { Idle, Executing, Failed };
std::string_view to_string(RuntimeState state);

/// What to switch to: a controller by name, a network, or a transition to be applied as it is (the paper's
/// transition request interface).
using Request = std::variant<model::NetworkName, model::Network, model::Transition>;

struct RequestOptions {
  model::Order order = model::Order::Seamless;
  Duration action_deadline = std::chrono::seconds(30);  ///< for each action
  /// Processes that go are killed, and nothing is done in them before (solve::Options::force).
  bool force = false;
  std::string who;  ///< asks, for the journal
};

struct RuntimeOptions {
  /// What to switch to where a failed transition cannot be undone; nothing: stay with what runs then.
  std::optional<model::NetworkName> fallback;
  model::Policies policies;       ///< about what fails by itself
  model::LookAhead look_ahead;    ///< what controllers that are kept ready may use
  std::filesystem::path journal;  ///< where what happens is kept (journal/journal.hpp); empty: nowhere
};

/// How far a controller is prepared that is to be kept ready.
struct Readiness {
  model::NetworkName controller;
  bool ready = false;  ///< as far as what runs permits
  std::size_t prepared =
      0;  ///< of its tasks: configured, running ones that it shares with what runs included
  std::size_t tasks = 0;
  std::string reason;  ///< why it is not ready
};

/// Owns a thread that executes one request after the other. A request that waits is superseded by a newer
/// one, as is one whose transition is still being prepared; one that is being committed is committed first.
/// All functions may be called from any thread and do not block unless they say so.
class Runtime {
 public:
  /// `host` and `catalog` must outlive this. The belief begins as what `host` observes.
  Runtime(std::string name, host::TaskHost& host, const model::ComponentCatalog& catalog,
          RuntimeOptions options = {});
  /// Waits for the actions in progress; leaves the tasks as they are.
  ~Runtime();
  Runtime(const Runtime&) = delete;
  Runtime& operator=(const Runtime&) = delete;

  [[nodiscard]] const std::string& name() const;

  /// Adds or replaces a controller that can be requested by name. Invalid networks are refused (all
  /// problems).
  Diagnostics add_controller(model::Network network);
  [[nodiscard]] std::vector<model::NetworkName> controllers() const;
  [[nodiscard]] std::optional<model::Network> controller(const model::NetworkName& name) const;

  /// Asks for a network; the future gets the outcome. Validation and solving happen before any action.
  std::future<SwitchResult> request(Request request, RequestOptions options = {});
  /// request() and wait. Blocks.
  SwitchResult switch_to(Request request, RequestOptions options = {});
  /// The transition that request() would execute now.
  Result<model::Transition> plan(const Request& request, RequestOptions options = {}) const;

  [[nodiscard]] RuntimeState state() const;
  /// The network held to be running; "" (the empty network's name) before the first request.
  [[nodiscard]] model::Network belief() const;
  /// Replaces the belief by a given network, or by what the host observes (the paper's reset_belief). During
  /// a transition this waits for its end (the call does not). Every request starts from what the host
  /// observes then; only after a given belief does the next one start from that.
  void reset_belief(std::optional<model::Network> network = std::nullopt);
  /// Keeps these controllers ready, the likeliest first, as far as the running one and the budget permit;
  /// replaces what was asked for before. A request for one of them then begins at its commit. The future gets
  /// one entry for each when that is done, which a request may delay.
  std::future<std::vector<Readiness>> prepare(std::vector<model::NetworkName> controllers);
  /// As it was when something changed last.
  [[nodiscard]] std::vector<Readiness> readiness() const;

  /// Where what runs differs from what shall run, as sentences; empty if they agree, and during a
  /// transition.
  [[nodiscard]] std::vector<std::string> observed_differences() const;

  /// Finished requests, oldest first; the last hundred are kept.
  [[nodiscard]] std::vector<SwitchResult> history() const;
  /// Events after `number`, oldest first. Waits up to `wait` for the first.
  [[nodiscard]] std::vector<Event> events(std::uint64_t after = 0, Duration wait = {}) const;

  [[nodiscard]] host::TaskHost& host();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::runtime
