// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/network.hpp>
#include <segue/runtime/belief.hpp>
#include <segue/runtime/halts.hpp>
#include <segue/runtime/look_ahead_savings.hpp>
#include <segue/runtime/pending.hpp>
#include <segue/runtime/planning.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/runtime_parts.hpp>
#include <segue/runtime/task_requests.hpp>
#include <segue/runtime/transaction.hpp>

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace segue::runtime::detail {

/// Plans transitions, executes them, and keeps the belief true. Plans may be made by any thread; whatever is
/// not const is called by the worker, but for reset().
class Switching {
 public:
  /// All must outlive this.
  Switching(RuntimeParts& parts, Halts& halts, TaskRequests& task_requests)
      : parts_(parts), halts_(halts), task_requests_(task_requests) {}

  // Plans
  [[nodiscard]] Result<SwitchPlan> plan(const model::Network& current, const Request& request,
                                        const RequestOptions& options,
                                        const Privileges& privileges = {}) const;
  /// A snapshot and a plan that starts from it; both leave out the same computers.
  [[nodiscard]] std::pair<Observation, Result<SwitchPlan>> plan_from_now(
      const Request& request, const RequestOptions& options, const Privileges& privileges = {}) const;
  /// The tasks and processes of the requested network; nothing: it may be about anything.
  [[nodiscard]] std::optional<NetworkParts> parts_of(const Request& request) const;

  // Execution. Both block.
  /// Executes the plan from `current`, fills in the result and takes a new snapshot for the belief.
  void carry_out(const model::Network& current, const SwitchPlan& plan, Duration action_deadline,
                 SwitchResult& result, std::function<void()> committed = {});
  /// Runs `work` in the state Executing, unless a request waits. `work` returns the state to continue with.
  void run_if_idle(const std::function<RuntimeState(RuntimeState before)>& work);

  // The belief
  /// Replaces it by a snapshot; parts that are not in `controller` become its `extra`.
  void adopt(const Observation& seen, const model::Network& controller, std::optional<model::Network> wanted);
  /// Before a transition from what was observed, unless a user has said what runs.
  void adopt_observed(const Observation& seen);
  /// Replaces the belief by `network`, or by a snapshot of the host; after a transition in progress.
  void reset(std::optional<model::Network> network);
  /// Leaves the state Executing, and performs a reset of the belief that was requested meanwhile.
  void settle(RuntimeState next);
  /// Conditions of the halt, and what watches the requests of tasks, look at the tasks of the running
  /// controller, as the belief has it now.
  void look_at_what_runs();
  /// From what should run, with reasons that are known; without `reports` the host is asked for them.
  [[nodiscard]] std::vector<std::string> differences_from(
      const model::Network& observed, const std::vector<task_host::ConnectionReport>* known = nullptr) const;
  void note_differences(const model::Network& observed);  ///< each once for as long as it lasts

  /// The part of what is observed that is kept on standby on purpose. The worker's.
  [[nodiscard]] const model::Network& standby() const { return standby_; }

 private:
  /// The network that a request by name or value asks for, with its properties.
  [[nodiscard]] Result<model::Network> requested_network(const Request& request,
                                                         const RequestOptions& options,
                                                         const Privileges& privileges) const;
  [[nodiscard]] Result<SwitchPlan> plan_given(const model::Network& current,
                                              const model::Transition& transition) const;
  [[nodiscard]] std::optional<Error> refusal_of(const RequestOptions& options,
                                                const Privileges& privileges) const;
  [[nodiscard]] Transaction::Options transaction_options(const model::Network& current,
                                                         Duration action_deadline,
                                                         std::function<void()> committed);
  /// Adopts the observed network, with the controller that it is or was asked to be.
  model::Network conclude(const SwitchPlan& plan, SwitchResult& result);
  void conclude_failed(const SwitchPlan& plan, const Observation& seen, SwitchResult& result);
  /// Brings the belief in line with it; returns what runs now, as part of a sentence.
  std::string adopt_after_failure(const SwitchPlan& plan, const Observation& seen,
                                  const SwitchResult& result);
  /// Adopts the observed network, with the controller that it is or was asked to be.
  void adopt_recognised();
  /// Not at tasks that change with the transition's commit, until the belief has what runs then.
  void look_away_from_changed(const model::Transition& transition);
  /// The network that was observed: `first`, `second` or a known controller; empty if it is none of them.
  [[nodiscard]] model::NetworkName name_of_running(const model::Network& observed,
                                                   const model::Network& first,
                                                   const model::Network& second) const;

  RuntimeParts& parts_;
  Halts& halts_;
  TaskRequests& task_requests_;
  const TransitionContext context_{parts_.host, parts_.catalog, parts_.log};
  // Of the worker.
  model::Network standby_;
  LookAheadSavings savings_;
  std::set<std::string> reported_differences_;  ///< those that last and were reported
};

}  // namespace segue::runtime::detail
