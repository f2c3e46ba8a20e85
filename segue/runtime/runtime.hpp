// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/diagnostic.hpp>
#include <segue/base/result.hpp>
#include <segue/base/wait.hpp>
#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>
#include <segue/runtime/event.hpp>
#include <segue/runtime/halt_result.hpp>
#include <segue/runtime/planned_switch.hpp>
#include <segue/runtime/pool_report.hpp>
#include <segue/runtime/readiness.hpp>
#include <segue/runtime/request_options.hpp>
#include <segue/runtime/switch_result.hpp>
#include <segue/runtime/unresolved_fault.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace segue::model {
class ComponentCatalog;
}
namespace segue::task_host {
class TaskHost;
}

/// The runtime (the paper's TaskNetworkHandler) accepts requests, solves and executes transitions, and keeps
/// the belief.
namespace segue::runtime {

enum class RuntimeState { Idle, Executing, Failed };
std::string_view to_string(RuntimeState state);

/// A controller by name ("drive"; several at once: "arm+drive", solve::combine), a network, or a transition
/// to be applied as it is (the paper's transition request interface).
using Request = std::variant<model::NetworkName, model::Network, model::Transition>;

/// A request, and what becomes of it.
struct AcceptedRequest {
  std::uint64_t number = 0;
  std::future<SwitchResult> result;
};

class ServedRuntime;
struct ControllerSet;
struct LoadedFile;
struct RobotSnapshot;
struct RuntimeOptions;

/// Owns a thread that executes requests sequentially. A newer request supersedes one that waits and one whose
/// transition is still in its prepare phase; a commit phase is finished first. All functions may be called
/// from any thread and do not block unless stated.
class Runtime {
 public:
  /// `host` and `catalog` must outlive this. The initial belief is a snapshot of `host`.
  Runtime(std::string name, task_host::TaskHost& host, const model::ComponentCatalog& catalog);
  Runtime(std::string name, task_host::TaskHost& host, const model::ComponentCatalog& catalog,
          RuntimeOptions options);
  /// Blocks until the actions in progress have ended; leaves the tasks as they are.
  ~Runtime();
  Runtime(const Runtime&) = delete;
  Runtime& operator=(const Runtime&) = delete;

  [[nodiscard]] const std::string& name() const;

  /// Adds or replaces a controller that can be requested by name. An invalid network is not added; the result
  /// lists all problems.
  Diagnostics add_controller(model::Network network);
  /// Replaces all controllers (but those that add_controller() added), the fallback and the list of files at
  /// once. Where a network cannot run here, nothing is: the result lists all problems. What runs stays.
  Diagnostics load(const ControllerSet& set);
  /// Like load(), and then the running controller goes to its new version by a transition like any other,
  /// once the requests before it are done. It supersedes no request; one that comes later supersedes its
  /// transition, which then follows that request. A controller that runs and is not in the set keeps running.
  /// If the transition is refused, or fails and is undone, the controllers are rolled back.
  std::future<ApplyResult> apply(ControllerSet set, RequestOptions options = {});
  /// The files of the last load() or apply() that is in force.
  [[nodiscard]] std::vector<LoadedFile> files() const;
  /// The version of the controller that runs; empty: none, or it is not known.
  [[nodiscard]] std::string version() const;
  [[nodiscard]] std::vector<model::NetworkName> controllers() const;
  [[nodiscard]] std::optional<model::Network> controller(const model::NetworkName& name) const;
  /// The names of the transitions that were loaded or applied, and one of them, to be requested; NotFound.
  [[nodiscard]] std::vector<std::string> transitions() const;
  [[nodiscard]] Result<model::Transition> transition(const std::string& name) const;

  /// Brings the robot to rest, for anybody, whoever commands it: the lease ends, what waits is cancelled,
  /// what is prepared or undone gives way, and only a commit in progress is finished first. Then the
  /// controller of ControllerSet::halt is requested. The result comes once its conditions of rest hold. If
  /// they do not in time, or the robot does not say what rest is, tasks that hold devices are stopped.
  /// Meanwhile, and with `latch` until release(), what is requested or applied is refused; so it is while a
  /// condition of model::Halt::when holds, which halts the robot by itself.
  std::shared_future<HaltResult> halt(HaltRequest request);
  /// InvalidState where nobody has stopped the robot with `latch`.
  Result<void> release(const std::string& who);
  /// The last halt, until something has been requested; nothing: there was none.
  [[nodiscard]] std::optional<Halted> halted() const;

  /// Requests a network; the future gets the result, accept() its number, too. Solving precedes any action.
  std::future<SwitchResult> request(Request request, RequestOptions options = {});
  AcceptedRequest accept(Request request, RequestOptions options = {});
  /// Calls request() and waits for the result. Blocks.
  SwitchResult switch_to(Request request, RequestOptions options = {});
  /// Requests that nothing runs, pools included, also of a robot that is halted or lost to another runtime.
  std::future<SwitchResult> take_down(std::string who = {});
  /// Cancels a request, 0: the newest one. One that waits ends at once; the transition of another one is
  /// undone, as where an action fails, if it is not past its point of commit. Its actions in progress end
  /// first, at their deadlines at most. What the runtime does by itself (repair, look-ahead) is not
  /// cancelled. The future gets the result of the request. NotFound where no such request is open,
  /// InvalidState where its transition is past its point of commit, has failed, or was superseded.
  Result<std::future<SwitchResult>> cancel(std::uint64_t request, std::string who);
  /// Requests what runs once more: all that is missing or faulty is repaired, also what was given up, and
  /// pools begin again. Refused where it is not known what should run.
  AcceptedRequest repair(RequestOptions options = {});
  /// The oldest first: the one in progress and the one that waits.
  [[nodiscard]] std::vector<OpenRequest> open_requests() const;
  /// The transition that request() would execute now.
  Result<model::Transition> plan(const Request& request, const RequestOptions& options = {}) const;
  /// plan(), with what changes and how long it takes.
  Result<PlannedSwitch> preview(const Request& request, const RequestOptions& options = {}) const;

  [[nodiscard]] RuntimeState state() const;
  /// The network believed to be running; before the first request its name is "".
  [[nodiscard]] model::Network belief() const;
  /// Replaces the belief by `network`, or by a snapshot of the host (the paper's reset_belief), in a
  /// transition at its end. A request starts from a snapshot, except the first one after a belief was given.
  void reset_belief(std::optional<model::Network> network = std::nullopt);
  /// Prepares these controllers and keeps them on standby, the likeliest first, as far as the running
  /// controller and the budget permit. Replaces the list of an earlier call. A request for a ready controller
  /// begins with its commit phase. The future gets one entry for each controller once done; requests take
  /// precedence.
  std::future<std::vector<Readiness>> prepare(std::vector<model::NetworkName> controllers);
  /// The readiness of the standby controllers after the last preparation.
  [[nodiscard]] std::vector<Readiness> readiness() const;

  /// Between the observed and the desired network; empty during a transition. Blocks for a snapshot.
  [[nodiscard]] std::vector<std::string> observed_differences() const;

  /// The parts of the robot and their problems; each process is asked once. Blocks while they are asked.
  [[nodiscard]] RobotSnapshot snapshot() const;
  /// As host().set_property(), and an event says so: `who` has set it.
  Result<void> set_property(const model::TaskId& task, std::string_view property, const type::Value& value,
                            const std::string& who, TimePoint deadline);
  /// As host().call(). An instance of a pool that has begun to carry it out when `wait` ends, and does so for
  /// nobody then, is ended and started again. Blocks until it has ended, or the instance has.
  Result<type::Value> call(const model::TaskId& task, std::string_view operation,
                           const type::Value& arguments, const Wait& wait);
  /// The pools of RuntimeOptions as they are now. Blocks while the host is asked.
  [[nodiscard]] std::vector<PoolReport> pools() const;
  /// Faults and leftovers that lasted longer than the policies permit attempts. From the last supervision.
  [[nodiscard]] std::vector<UnresolvedFault> unresolved() const;
  /// Faults that are being mended, or will be: for as long as the policies permit further attempts.
  [[nodiscard]] std::vector<UnresolvedFault> in_repair() const;

  /// Finished requests, oldest first; the last hundred are kept.
  [[nodiscard]] std::vector<SwitchResult> history() const;
  [[nodiscard]] const std::filesystem::path& journal() const;  ///< its file; empty: none is kept
  /// Events after `after`, oldest first. Blocks until there is one, at most as long as `wait` says.
  [[nodiscard]] std::vector<Event> events(std::uint64_t after = 0, const Wait& wait = {}) const;
  [[nodiscard]] task_host::TaskHost& host();
  [[nodiscard]] const model::ComponentCatalog& components() const;
  /// For servers, such as RuntimeService. Lives as long as this.
  [[nodiscard]] ServedRuntime& served();

 private:
  friend class ServedRuntime;
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::runtime
