// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/runtime/event_log.hpp>
#include <segue/runtime/execution.hpp>
#include <segue/runtime/planning.hpp>
#include <segue/runtime/runtime.hpp>

#include <condition_variable>
#include <deque>
#include <list>
#include <map>
#include <mutex>
#include <thread>

namespace segue::runtime {

namespace detail {

/// What the host showed at some moment. Tasks may have changed by themselves since: adopt() takes the events
/// after that moment into account.
struct Observation {
  model::Network network;
  std::uint64_t task_events = 0;  ///< how many had come before
};

/// A request and whom to answer.
struct Job {
  std::uint64_t number = 0;
  Request request;
  RequestOptions options;
  std::promise<SwitchResult> promise;
};

}  // namespace detail

struct Runtime::Implementation {
  Implementation(std::string robot, host::TaskHost& task_host, const model::ComponentCatalog& components)
      : name(std::move(robot)), host(task_host), catalog(components) {
    host.set_listener([this](const host::HostEvent& event) {
      std::visit([this](const auto& what) { on_event(what); }, event);
    });
    adopt(look());
    worker = std::thread([this] { work(); });
  }

  ~Implementation() {
    host.set_listener({});
    std::optional<detail::Job> left;
    {
      const std::lock_guard lock(mutex);
      stopping = true;
      left.swap(waiting);
      if (execution) {
        execution->cancel();
      }
    }
    wake.notify_all();
    log.close();
    if (left) {
      answer(*left, ended_before(*left));
    }
    worker.join();
  }

  std::future<SwitchResult> accept(Request request, RequestOptions options);
  /// The controller of a name; the empty name is the empty network.
  Result<model::Network> resolve(const model::NetworkName& wanted) const;
  tl::expected<detail::Plan, detail::Refusal> plan(const model::Network& current, const Request& request,
                                                   const RequestOptions& options) const;
  model::Network held() const {
    const std::lock_guard lock(mutex);
    return belief;
  }
  detail::Observation look() const;
  /// What a new request starts from: what runs, unless the belief was given.
  detail::Observation starting_point() const;

  void work();
  SwitchResult serve(const detail::Job& job);
  void execute(const detail::Job& job, detail::Plan plan, SwitchResult& result);
  void run_actions(const detail::Job& job, const model::Transition& transition, SwitchResult& result);
  void conclude(detail::Plan plan, SwitchResult& result);
  void conclude_failed(const detail::Plan& plan, SwitchResult& result);
  /// Believes what was seen, and what tasks told since.
  void adopt(detail::Observation seen);
  /// Believes what a person says, whatever runs.
  void adopt_given(model::Network network);
  void report_differences(const model::Network& expected, const model::Network& observed);
  model::NetworkName true_name(const model::Network& observed, const model::Network& first,
                               const model::Network& second) const;
  void settle(RuntimeState next);
  void answer(detail::Job& job, SwitchResult result);
  SwitchResult superseded(const detail::Job& job) const;
  SwitchResult ended_before(const detail::Job& job) const;
  SwitchResult refused(const detail::Job& job, SwitchResult result, detail::Refusal refusal);
  void on_event(const host::TaskEvent& event);
  void on_event(const host::ProcessEvent& event);
  void on_action(const ActionRecord& record);
  void reset(std::optional<model::Network> network);
  Diagnostics add(model::Network network);

  const std::string name;
  host::TaskHost& host;
  const model::ComponentCatalog& catalog;
  detail::EventLog log;

  mutable std::mutex mutex;  ///< guards all below; never held while the host is called
  std::condition_variable wake;
  bool stopping = false;
  std::uint64_t requests = 0;
  std::map<model::NetworkName, model::Network> controllers;
  std::optional<detail::Job> waiting;
  RuntimeState state = RuntimeState::Idle;
  model::Network belief;
  /// For each task, the last state that it took by itself, and the number of that event.
  std::map<model::TaskId, std::pair<std::uint64_t, TaskState>> told;
  std::uint64_t task_events = 0;
  bool belief_given = false;  ///< by reset_belief: the next request starts from it, whatever is observed
  std::optional<std::optional<model::Network>> reset_wanted;  ///< during a transition
  std::deque<SwitchResult> history;
  std::shared_ptr<detail::Execution> execution;

  std::list<std::shared_ptr<detail::Execution>> hanging;  ///< given up; the worker's alone
  std::thread worker;
};

}  // namespace segue::runtime
