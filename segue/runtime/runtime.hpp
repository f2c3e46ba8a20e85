// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/host/task_host.hpp>
#include <segue/model/component.hpp>
#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>
#include <segue/solve/solve.hpp>

#include <cstdint>
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
  Duration started{0};  ///< since the begin of the execution
  Duration duration{0};
  std::optional<Error> error;  ///< nothing: done
  bool executed = false;       ///< false: an earlier action failed
};

/// What became of a request. `solve_time` and `duration` are wall-clock; actions are in the order of
/// execution.
struct SwitchResult {
  Outcome outcome = Outcome::Done;
  std::uint64_t request = 0;
  model::NetworkName from;
  model::NetworkName to;
  Duration solve_time{0};
  Duration duration{0};
  Duration commit{0};  ///< from the first to the last action of the commit phase
  std::vector<ActionRecord> actions;
  std::optional<Error> error;  ///< why refused or failed, and where
  Diagnostics diagnostics;     ///< all findings of validation, where refused
};

enum class RuntimeState { Idle, Executing, Failed };
std::string_view to_string(RuntimeState state);

enum class EventKind {
  RequestAccepted,
  TransitionStarted,
  ActionDone,
  ActionFailed,
  TransitionDone,
  TransitionFailed,
  RequestRefused,
  RequestSuperseded,
  TaskState,
  Process,
  Difference,
  BeliefReset
};
std::string_view to_string(EventKind kind);

/// Numbered without gaps from 1; the last few thousand are kept.
struct Event {
  std::uint64_t number = 0;
  std::chrono::system_clock::time_point time;
  EventKind kind = EventKind::RequestAccepted;
  std::string subject;  ///< task, action or network
  std::string message;
};

/// What to switch to: a controller by name, a network, or a transition to be applied as it is (the paper's
/// transition request interface).
using Request = std::variant<model::NetworkName, model::Network, model::Transition>;

struct RequestOptions {
  model::Order order = model::Order::Paper;
  Duration action_deadline = std::chrono::seconds(30);  ///< for each action
};

/// Owns a thread that executes one request after the other: a request that waits is superseded by a newer
/// one. All functions may be called from any thread and do not block unless they say so.
class Runtime {
 public:
  /// `host` and `catalog` must outlive this. The belief begins as what `host` observes.
  Runtime(std::string name, host::TaskHost& host, const model::ComponentCatalog& catalog);
  /// Waits for the action in progress; leaves the tasks as they are.
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
  /// Where belief and observation differ, as sentences; empty if they agree, and during a
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
