// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/runtime/belief.hpp>
#include <segue/runtime/event_log.hpp>
#include <segue/runtime/halts.hpp>
#include <segue/runtime/instance_calls.hpp>
#include <segue/runtime/journaling.hpp>
#include <segue/runtime/leases.hpp>
#include <segue/runtime/look_ahead.hpp>
#include <segue/runtime/pending.hpp>
#include <segue/runtime/planning.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/transaction.hpp>
#include <segue/runtime/worker_memory.hpp>
#include <segue/runtime/worker_state.hpp>
#include <segue/solve/repair.hpp>

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <utility>

namespace segue::runtime {

struct Runtime::Implementation : detail::SharedState, private detail::WorkerMemory {
  Implementation(std::string robot, task_host::TaskHost& task_host, const model::ComponentCatalog& components,
                 RuntimeOptions runtime_options);
  ~Implementation();

  // Requests (runtime_requests.cpp)
  AcceptedRequest accept(Request request, RequestOptions options);
  AcceptedRequest repair(RequestOptions options);
  /// Its turn comes next; returns the one whose place it takes.
  std::optional<detail::PendingRequest> enqueue(detail::PendingRequest job) SEGUE_REQUIRES(mutex);
  Result<model::Network> resolve(const model::NetworkName& wanted) const;  ///< empty: the empty network
  [[nodiscard]] std::optional<detail::NetworkParts> parts_of(const Request& request) const;
  detail::Planned plan(const model::Network& current, const Request& request,
                       const RequestOptions& options) const;
  /// A snapshot and a plan that starts from it; both leave out the same computers.
  std::pair<detail::Observation, detail::Planned> plan_from_now(const Request& request,
                                                                const RequestOptions& options) const;
  Result<std::uint64_t> take_lease(std::string holder);
  type::Value mission(std::uint64_t after, bool with_plan);
  /// Why nothing is done any more: another runtime has got the robot. Without the mutex.
  [[nodiscard]] std::optional<Error> refusal_of_lost_robot() const;
  /// Why a request with these options cannot be accepted.
  [[nodiscard]] std::optional<Error> refusal_of(const RequestOptions& options) const;
  [[nodiscard]] std::optional<detail::Refusal> refusal_of_take_over(const Request& request,
                                                                    const RequestOptions& options) const;
  Result<std::vector<ControllerConflict>> conflicts(const std::vector<model::NetworkName>& names) const;
  SwitchResult serve(detail::PendingRequest& job);
  void answer(detail::PendingRequest& job, SwitchResult result);
  SwitchResult superseded(const detail::PendingRequest& job) const;
  SwitchResult cancelled(const detail::PendingRequest& job) const;
  SwitchResult refused(SwitchResult result, detail::Refusal refusal);
  void remember(SwitchResult result);
  // (runtime_cancel.cpp)
  Result<std::future<SwitchResult>> cancel(std::uint64_t request, std::string who);
  std::vector<OpenRequest> open_requests() const;
  Result<std::future<SwitchResult>> cancel_served(const std::string& who) SEGUE_REQUIRES(mutex);
  /// Where one has not ended that was made with this lease, which is lost.
  void cancel_requests_of(std::uint64_t lease, const std::string& who);

  // Halts (runtime_halt.cpp)
  std::future<SwitchResult> request_rest(const std::string& by, Request request, Duration action_deadline);
  void drop(const std::string& by, std::optional<detail::PendingRequest> request,
            std::optional<detail::PendingApply> files);
  detail::Halts::Ways ways_to_rest();
  [[nodiscard]] detail::DevicesStopped with_devices_stopped() const;
  [[nodiscard]] bool may_halt() const;  ///< something runs, and it is known what rest is
  void stop_holder(const std::optional<detail::Leases::Holder>& holder);
  std::shared_future<HaltResult> end_lease(std::uint64_t lease, bool keep);
  /// Conditions of the halt look at the tasks of the running controller, as the belief has it now.
  void look_at_what_runs();
  /// Not at tasks that change with the transition's commit, until the belief has what runs then.
  void look_away_from_changed(const model::Transition& transition);

  // Controllers and their files (runtime_apply.cpp)
  Diagnostics add(model::Network network);
  Diagnostics load(const ControllerSet& set);
  std::future<ApplyResult> apply(ControllerSet set, RequestOptions options);
  /// The definitions are those of the set from now on; returns the files whose place `job` takes. With the
  /// mutex held. `runs` is the running controller.
  std::optional<detail::PendingApply> take_files(detail::PendingApply job, const ControllerSet& set,
                                                 const model::NetworkName& runs) SEGUE_REQUIRES(mutex);
  Diagnostics check(const ControllerSet& set) const;
  std::vector<ControllerChange> compare(const ControllerSet& set) const;
  /// The definitions with those of the set.
  [[nodiscard]] detail::Definitions definitions_with(const ControllerSet& set) const SEGUE_REQUIRES(mutex);
  /// Takes the running controller to its version in the applied files. Blocks.
  RuntimeState serve(detail::PendingApply job, RuntimeState before);
  /// The transition, or nothing where there is nothing to do.
  std::optional<SwitchResult> update(const detail::PendingApply& job, const model::Network& controller);
  /// Where a newer request came first: the job waits again. False where newer files were applied.
  bool postpone(detail::PendingApply& job);
  void take_back(detail::PendingApply& job);
  void answer(detail::PendingApply& job, Outcome outcome, std::optional<SwitchResult> transition,
              std::optional<Error> error);

  // The worker and its transitions (runtime_worker.cpp)
  void work();
  [[nodiscard]] bool may_serve() const SEGUE_REQUIRES(mutex);  ///< the request that waits
  /// Executes the plan from `current`, fills in the result and takes a new snapshot for the belief. Blocks.
  void carry_out(const model::Network& current, const detail::SwitchPlan& plan, Duration action_deadline,
                 SwitchResult& result, std::function<void()> committed = {});
  /// Returns what was observed to run.
  model::Network conclude(const detail::SwitchPlan& plan, SwitchResult& result);
  void begin(const std::shared_ptr<detail::Transaction>& begun, Cause cause);
  void conclude_failed(const detail::SwitchPlan& plan, const detail::Observation& seen, SwitchResult& result);
  /// Replaces the belief by a snapshot; parts that are not in `controller` become its `extra`.
  void adopt(const detail::Observation& seen, const model::Network& controller,
             std::optional<model::Network> wanted);
  void note_differences(const model::Network& observed);  ///< each once for as long as it lasts
  /// From what should run, with reasons that are known; without `reports` the host is asked for them.
  [[nodiscard]] std::vector<std::string> differences_from(
      const model::Network& observed, const std::vector<task_host::ConnectionReport>* known = nullptr) const;
  /// Which network was observed: `first`, `second` or a known controller; empty if it is none of them.
  model::NetworkName name_of_running(const model::Network& observed, const model::Network& first,
                                     const model::Network& second) const;
  std::optional<model::Network> known(const model::NetworkName& name) const;
  std::optional<model::Network> fallback() const;
  std::optional<model::Network> expanded(std::optional<model::Network> network) const;  ///< as it runs
  /// Runs `work` in the state Executing, unless a request waits. `work` returns the state to continue with.
  void run_if_idle(const std::function<RuntimeState(RuntimeState before)>& work);
  void settle(RuntimeState next);
  void reset(std::optional<model::Network> network);
  void on_event(const task_host::TaskEvent& event);
  void on_event(const task_host::ProcessEvent& event);
  void on_event(const task_host::ComputerEvent& event);
  void on_event(const task_host::LossEvent& event);
  void wake_worker();

  // Pools of processes (runtime_pools.cpp)
  /// What of the network belongs to pools that run, as it is there; and all else.
  [[nodiscard]] model::Network pool_part(const model::Network& network) const;
  [[nodiscard]] model::Network without_pools(const model::Network& network) const;
  /// Why a network cannot be requested: it names what belongs to a pool.
  [[nodiscard]] std::optional<detail::Refusal> refusal_for_pools(const model::Network& network) const;
  /// Starts instances that do not run, or work for nobody, each by a transition of its own.
  void look_after_pools();
  /// Takes a snapshot, and notes which instances run.
  std::vector<detail::DetectedFault> find_pool_faults();
  void start_instance(const detail::DetectedFault& fault);
  void note_pool_faults(const std::vector<detail::DetectedFault>& faults);
  [[nodiscard]] std::vector<PoolReport> report_pools(const std::vector<task_host::TaskReport>& tasks) const;
  Look look();                                 // (runtime_health.cpp)
  Look judge(task_host::TaskHost::View seen);  ///< without differences
  [[nodiscard]] std::vector<detail::DetectedFault> faults_in(const model::Network& observed) const;

  // Supervision between requests, in the worker thread (runtime_supervise.cpp, runtime_faults.cpp)
  /// Takes a snapshot, repairs faults, removes leftovers and prepares standby controllers. Blocks.
  void supervise();
  /// Does what is left to do, where the robot is still commanded; returns what cannot be done.
  std::vector<UnresolvedFault> put_right(const std::set<model::HostName>& returned,
                                         const detail::Observation& seen);
  /// `hosts` had returned before the snapshot was taken.
  void bring_back(const std::set<model::HostName>& hosts, const detail::Observation& seen);
  /// Both return what as many attempts as the policy permits could not resolve.
  std::vector<UnresolvedFault> handle_faults(const detail::Observation& seen);
  std::vector<UnresolvedFault> collect_leftovers(const detail::Observation& seen);
  /// Forgets processes that ended if they are there again, or are no longer wanted.
  void forget_ended(const model::Network& observed);
  void note_in_repair(const std::vector<detail::DetectedFault>& faults);
  void report_given_up(const std::vector<detail::DetectedFault>& faults);
  void fall_back(const detail::Observation& seen);
  void look_ahead();
  /// Whether there is anything to prepare, or to answer.
  [[nodiscard]] bool looks_ahead() const SEGUE_REQUIRES(mutex);
  /// Executes what concerns `scope` of the transition to the desired network, beside which `pools_part` runs.
  /// `force`: processes that it replaces are killed. Whether that is done.
  bool repair(Cause cause, const detail::Observation& seen, const solve::RepairScope& scope,
              const model::Network& pools_part, bool force = false);
  [[nodiscard]] std::vector<detail::PrepareRequest> known_prepare_requests(
      const model::Network& controller) const;
  [[nodiscard]] detail::LookAheadPlan plan_ahead(const model::Network& controller) const;
  [[nodiscard]] TimePoint next_supervision() const;
  std::future<std::vector<Readiness>> prepare(std::vector<model::NetworkName> wanted, std::uint64_t lease);
  void answer_prepare(std::vector<Readiness> answer);

  const std::string name;
  task_host::TaskHost& host;
  const model::ComponentCatalog& catalog;
  const RuntimeOptions options;
  const model::Network pools = model::pool_network(options.pools);
  detail::EventLog log;
  detail::JournalKeeper journal{options.journal, options.robot_folder, log};
  detail::Leases leases{log, journal, changes};
  detail::InstanceCalls instance_calls{host, pools, [this] { wake_worker(); }};
  detail::Belief belief{host};
  detail::TroubleTimes trouble_times;
  const detail::TransitionContext context{host, catalog, log};
  std::thread worker;
  detail::Halts halts{host, log, ways_to_rest()};
};

}  // namespace segue::runtime
