// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/runtime/belief.hpp>
#include <segue/runtime/event_log.hpp>
#include <segue/runtime/journaling.hpp>
#include <segue/runtime/look_ahead.hpp>
#include <segue/runtime/planning.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/transaction.hpp>
#include <segue/runtime/watch.hpp>
#include <segue/solve/repair.hpp>

#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <thread>

namespace segue::runtime {

namespace detail {

/// A request and whom to answer.
struct Job {
  std::uint64_t number = 0;
  Request request;
  RequestOptions options;
  std::promise<SwitchResult> promise;
};

}  // namespace detail

struct Runtime::Implementation {
  Implementation(std::string robot, host::TaskHost& task_host, const model::ComponentCatalog& components,
                 RuntimeOptions runtime_options);
  ~Implementation();

  // Requests (runtime_requests.cpp)
  std::future<SwitchResult> accept(Request request, RequestOptions options);
  /// The controller of a name; the empty name is the empty network.
  Result<model::Network> resolve(const model::NetworkName& wanted) const;
  tl::expected<detail::Plan, detail::Refusal> plan(const model::Network& current, const Request& request,
                                                   const RequestOptions& options) const;
  SwitchResult serve(const detail::Job& job);
  void answer(detail::Job& job, SwitchResult result);
  SwitchResult superseded(const detail::Job& job) const;
  SwitchResult ended_before(const detail::Job& job) const;
  SwitchResult refused(const detail::Job& job, SwitchResult result, detail::Refusal refusal);
  void remember(SwitchResult result);

  // The worker and its transitions (runtime_worker.cpp)
  void work();
  /// From `current` as planned; fills in the result and believes what it led to.
  void carry_out(const model::Network& current, const detail::Plan& plan, Duration action_deadline,
                 SwitchResult& result);
  void conclude(const detail::Plan& plan, SwitchResult& result);
  void conclude_failed(const detail::Plan& plan, const detail::Observation& seen, SwitchResult& result);
  /// Believes what was seen; what `controller` lacks of it stands beside.
  void adopt(const detail::Observation& seen, const model::Network& controller,
             std::optional<model::Network> wanted);
  /// Tells of each difference once, as long as it lasts.
  void note_differences(const model::Network& observed);
  /// The name of the network that truly runs, if it is one that anybody knows.
  model::NetworkName true_name(const model::Network& observed, const model::Network& first,
                               const model::Network& second) const;
  std::optional<model::Network> known(const model::NetworkName& name) const;
  /// Does something to the robot while no request is served.
  void by_itself(const std::function<RuntimeState(RuntimeState before)>& work);
  void settle(RuntimeState next);
  void reset(std::optional<model::Network> network);
  void on_event(const host::TaskEvent& event);
  void on_event(const host::ProcessEvent& event);
  void note_news();
  Diagnostics add(model::Network network);

  // What is done without a request (runtime_care.cpp): in the worker's thread
  /// Looks at what runs; repairs, tidies up, and keeps controllers ready.
  void care();
  void repair(const detail::Observation& seen);
  void tell_given_up(const std::vector<detail::Ailment>& ailing);
  void fall_back(const detail::Observation& seen);
  void tidy(const detail::Observation& seen);
  void look_ahead();
  /// The part of the way from what was seen to what shall run that concerns a scope.
  void mend(Cause cause, const detail::Observation& seen, const solve::RepairScope& scope);
  [[nodiscard]] std::vector<detail::Wish> known_wishes() const;
  [[nodiscard]] detail::LookAheadPlan plan_ahead(const model::Network& controller) const;
  [[nodiscard]] TimePoint next_care() const;
  std::future<std::vector<Readiness>> wish(std::vector<model::NetworkName> wanted);
  void answer_wish(std::vector<Readiness> answer);

  const std::string name;
  host::TaskHost& host;
  const model::ComponentCatalog& catalog;
  const RuntimeOptions options;
  detail::EventLog log;
  detail::JournalKeeper journal{options.journal, log};
  detail::Belief belief{host};
  const detail::Ground ground{host, catalog, log};

  mutable std::mutex mutex;  ///< guards all below; never held while the host is called
  std::condition_variable wake;
  bool stopping = false;
  std::uint64_t requests = 0;
  std::map<model::NetworkName, model::Network> controllers;
  std::optional<detail::Job> waiting;
  RuntimeState state = RuntimeState::Idle;
  std::optional<std::optional<model::Network>> reset_wanted;  ///< during a transition
  std::deque<SwitchResult> history;
  std::shared_ptr<detail::Transaction> transaction;
  bool news = false;  ///< something happened by itself
  std::vector<model::NetworkName> wishes;
  std::optional<std::promise<std::vector<Readiness>>> wish_waiting;
  std::vector<Readiness> readiness;
  bool look_ahead_due = false;

  // The worker's alone.
  detail::Watch watch{options.policies.restart};
  detail::Watch tidying{options.policies.restart};
  std::set<std::string> noted;  ///< differences that were told
  model::Network warm;          ///< what stands beside on purpose
  TimePoint next_look = RealClock::instance().now();

  std::thread worker;
};

}  // namespace segue::runtime
