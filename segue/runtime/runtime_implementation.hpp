// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/runtime/halts.hpp>
#include <segue/runtime/pending.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/runtime_parts.hpp>
#include <segue/runtime/served_runtime.hpp>
#include <segue/runtime/supervisor.hpp>
#include <segue/runtime/switching.hpp>
#include <segue/runtime/task_requests.hpp>

#include <cstdint>
#include <functional>
#include <future>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace segue::runtime {

/// Takes requests, files and halts from any thread, and serves them one after the other in the worker's.
struct Runtime::Implementation : detail::RuntimeParts {
  Implementation(std::string robot, task_host::TaskHost& task_host, const model::ComponentCatalog& components,
                 RuntimeOptions runtime_options);
  ~Implementation();

  // Requests (runtime_requests.cpp)
  AcceptedRequest accept(Request request, RequestOptions options, const detail::Privileges& privileges = {});
  AcceptedRequest repair(RequestOptions options);
  Result<std::uint64_t> take_lease(std::string holder);
  std::future<std::vector<Readiness>> prepare(std::vector<model::NetworkName> wanted, std::uint64_t lease);
  Result<std::future<SwitchResult>> cancel(std::uint64_t request, std::string who);
  /// Where one has not ended that was made with this lease, which is lost.
  void cancel_requests_of(std::uint64_t lease, const std::string& who);
  /// Why a request with these options cannot be accepted.
  [[nodiscard]] std::optional<Error> refusal_of(const RequestOptions& options,
                                                const detail::Privileges& privileges = {}) const;
  [[nodiscard]] std::optional<Error> refusal_of_take_over(const Request& request,
                                                          const RequestOptions& options) const;
  /// Called with the queue locked: whether the request may take its place there. Fills in why it may not.
  bool admit(const detail::PendingRequest& job, std::optional<Error>& refusal);
  /// Blocks until it is done.
  SwitchResult serve(detail::PendingRequest& job);
  void answer(detail::PendingRequest& job, SwitchResult result);
  void remember(SwitchResult result);
  SwitchResult refused(SwitchResult result, Error refusal);
  /// It was not served.
  SwitchResult cancelled(const detail::PendingRequest& job) const;

  // Halts (runtime_halt.cpp)
  std::future<SwitchResult> request_rest(const std::string& by, Request request, Duration action_deadline);
  void drop(const std::string& by, detail::RequestQueue::Waiting dropped);
  detail::Halts::Ways ways_to_rest();
  [[nodiscard]] detail::DevicesStopped with_devices_stopped() const;
  [[nodiscard]] bool may_halt() const;  ///< something runs, and it is known what rest is
  void stop_holder(const std::optional<detail::Leases::Holder>& holder);
  std::shared_future<HaltResult> end_lease(std::uint64_t lease, bool keep);

  // Controllers and their files (runtime_apply.cpp)
  Diagnostics add(model::Network network);
  Diagnostics load(const ControllerSet& set);
  std::future<ApplyResult> apply(ControllerSet set, RequestOptions options);
  /// Called with the queue locked: the controllers are those of the set from now on. `older`: files whose
  /// place `job` takes; null: none. `runs` is the running controller.
  void take_files(detail::PendingApply& job, detail::PendingApply* older, const ControllerSet& set,
                  const model::NetworkName& runs);
  /// Takes the running controller to its version in the applied files. Blocks.
  RuntimeState serve(detail::PendingApply job, RuntimeState before);
  /// The transition, or nothing where there is nothing to do.
  std::optional<SwitchResult> update(const detail::PendingApply& job, const model::Network& controller);
  void take_back(detail::PendingApply& job);
  void answer(detail::PendingApply& job, Outcome outcome, std::optional<SwitchResult> transition,
              std::optional<Error> error);

  // The worker and the events of the host (runtime_worker.cpp)
  void work();
  void on_event(const task_host::TaskEvent& event);
  void on_event(const task_host::ProcessEvent& event);
  void on_event(const task_host::ComputerEvent& event);
  void on_event(const task_host::LossEvent& event);

  detail::Halts halts{host, log, ways_to_rest()};
  detail::TaskRequests task_requests{
      host, log, [this](const std::string& controller, const std::string& who) {
        accept(model::NetworkName(controller), {.who = who}, {.yields_to_halt = true});
      }};
  detail::Switching switching{*this, halts, task_requests};
  detail::Supervisor supervisor{*this, switching, halts};
  ServedRuntime served{*this};
  std::thread worker;
};

}  // namespace segue::runtime
