// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/controller_names.hpp>
#include <segue/runtime/runtime_implementation.hpp>

#include <algorithm>
#include <utility>

namespace segue::runtime {

using detail::name_of;
using detail::PendingRequest;

model::NetworkName detail::name_of(const Request& request) {
  struct Visitor {
    model::NetworkName operator()(const model::NetworkName& name) const { return name; }
    model::NetworkName operator()(const model::Network& network) const { return network.name; }
    model::NetworkName operator()(const model::Transition& transition) const { return transition.to; }
  };
  return std::visit(Visitor{}, request);
}

namespace {

SwitchResult new_result(const PendingRequest& job) {
  SwitchResult result;
  result.request = job.number;
  result.who = job.options.who;
  result.time = std::chrono::system_clock::now();
  result.to = name_of(job.request);
  result.order = job.options.order;
  return result;
}

SwitchResult superseded(const PendingRequest& job) {
  SwitchResult result = new_result(job);
  result.outcome = Outcome::Superseded;
  result.error = fail(ErrorCode::Superseded, "a newer request took its place", result.to.str());
  return result;
}

}  // namespace

AcceptedRequest Runtime::Implementation::accept(Request request, RequestOptions request_options,
                                                const detail::Privileges& privileges) {
  if (auto* controller = std::get_if<model::NetworkName>(&request)) {
    *controller = model::joined_name(model::controllers_in(controller->str()));
  } else if (const auto* network = std::get_if<model::Network>(&request)) {
    journal.loaded(*network);
  }
  request_options.action_deadline = std::min(request_options.action_deadline, detail::kLongestDeadline);
  auto refusal = refusal_of_take_over(request, request_options);
  PendingRequest job{0, std::move(request), std::move(request_options), {}};
  AcceptedRequest accepted{0, job.promise.get_future()};
  job.privileges = privileges;
  job.parts = switching.parts_of(job.request);
  auto place = queue.put(job, [&] { return admit(job, refusal); });
  accepted.number = place.number;
  if (refusal) {
    SwitchResult result = new_result(job);  // NOLINT(bugprone-use-after-move): only what is admitted is moved
    result.from = result.runs = belief.controller().name;
    result.from_version = result.runs_version = belief.version();
    answer(job, refused(std::move(result), std::move(*refusal)));
  } else if (place.older) {
    log.add(EventKind::RequestSuperseded, name_of(place.older->request).str(),
            "request " + std::to_string(place.older->number) + " was superseded by a newer one");
    SwitchResult result = superseded(*place.older);
    journal.ended(std::as_const(result));
    answer(*place.older, std::move(result));
  }
  return accepted;
}

bool Runtime::Implementation::admit(const PendingRequest& job, std::optional<Error>& refusal) {
  journal.accepted(job.number, job.options.who, name_of(job.request));
  if (auto why = refusal_of(job.options, job.privileges)) {
    refusal = std::move(*why);
  }
  if (refusal) {
    return false;
  }
  leases.take_over(job.options);
  if (!job.privileges.although_halted) {
    halts.forget();
  }
  log.add(EventKind::RequestAccepted, name_of(job.request).str(), "request " + std::to_string(job.number));
  return true;
}

AcceptedRequest Runtime::Implementation::repair(RequestOptions request_options) {
  const auto held = belief.held();
  const bool unknown = !held.wanted && held.controller.name.empty() && !held.controller.empty();
  if (unknown) {
    PendingRequest job{0, model::NetworkName(), std::move(request_options), {}};
    AcceptedRequest refused_request{0, job.promise.get_future()};
    SwitchResult result =
        refused(new_result(job), fail(ErrorCode::InvalidState,
                                      "what runs was not requested, so it is not known what to repair; "
                                      "`segue switch` to a controller"));
    job.promise.set_value(std::move(result));
    return refused_request;
  }
  pools.begin_again();
  if (held.wanted) {
    return accept(host.condensed(*held.wanted), std::move(request_options));
  }
  return accept(held.controller.name, std::move(request_options));
}

/// A request that would take the robot over, and could not be carried out, takes it from nobody.
std::optional<Error> Runtime::Implementation::refusal_of_take_over(
    const Request& request, const RequestOptions& request_options) const {
  if (!leases.would_take_over(request_options)) {
    return std::nullopt;
  }
  const auto plan = switching.plan(belief.starting_point().network, request, request_options);
  return plan ? std::nullopt : std::optional(plan.error());
}

std::optional<Error> Runtime::Implementation::refusal_of(const RequestOptions& request_options,
                                                         const detail::Privileges& privileges) const {
  if (auto refusal = privileges.although_halted ? std::nullopt : halts.refusal()) {
    return refusal;
  }
  const auto halted = privileges.yields_to_halt ? halts.halted() : std::nullopt;
  if (halted) {
    return fail(ErrorCode::InvalidState, "the robot was halted by " + halted->request.who +
                                             ", and requests of tasks do not end that; `segue switch` does");
  }
  return leases.refusal_of(request_options);
}

Result<std::uint64_t> Runtime::Implementation::take_lease(std::string holder) {
  if (auto lost = refusal_of_lost_robot()) {
    return std::move(*lost);
  }
  if (auto refusal = halts.refusal()) {
    return std::move(*refusal);
  }
  return leases.take(std::move(holder));
}

std::future<std::vector<Readiness>> Runtime::Implementation::prepare(std::vector<model::NetworkName> wanted,
                                                                     std::uint64_t lease) {
  if (auto readiness = standby_requests.request(std::move(wanted), lease)) {
    queue.wake();
    return std::move(*readiness);
  }
  std::promise<std::vector<Readiness>> nothing;
  nothing.set_value({});
  return nothing.get_future();
}

SwitchResult Runtime::Implementation::serve(PendingRequest& job) {
  const TimePoint begin = RealClock::instance().now();
  SwitchResult result = new_result(job);
  pools.keep(!job.privileges.ends_pools);
  const auto [current, plan] = switching.plan_from_now(job.request, job.options, job.privileges);
  result.from = current.network.name;
  result.from_version = belief.version();
  result.solve_time = RealClock::instance().now() - begin;
  if (!plan) {
    result.runs = result.from;
    result.runs_version = result.from_version;
    return refused(std::move(result), plan.error());
  }
  result.to_version = plan->controller.version;
  switching.adopt_observed(current);
  switching.carry_out(current.network, *plan, job.options.action_deadline, result, [&, &wanted = *plan] {
    if (job.at_commit) {
      switching.adopt(belief.observe(), wanted.controller, wanted.controller);
      job.is_answered = true;
      job.promise.set_value(result);
    }
  });
  if (result.ok()) {
    supervisor.begin_anew();
  }
  return result;
}

void Runtime::Implementation::answer(PendingRequest& job, SwitchResult result) {
  remember(result);
  if (!job.is_answered) {
    job.promise.set_value(std::move(result));
  }
}

void Runtime::Implementation::remember(SwitchResult result) {
  history.add(result);
  queue.conclude(result);
}

SwitchResult Runtime::Implementation::cancelled(const PendingRequest& job) const {
  SwitchResult result = new_result(job);
  result.outcome = Outcome::Refused;
  result.error =
      fail(ErrorCode::Cancelled, "the runtime ended before the request was served", result.to.str());
  return result;
}

SwitchResult Runtime::Implementation::refused(SwitchResult result, Error refusal) {
  result.outcome = Outcome::Refused;
  result.error = std::move(refusal);
  log.add(EventKind::RequestRefused, result.to.str(), to_string(*result.error));
  journal.ended(std::as_const(result));
  return result;
}

Result<std::future<SwitchResult>> Runtime::Implementation::cancel(std::uint64_t request, std::string who) {
  who = who.empty() ? "somebody" : std::move(who);
  auto found = queue.cancel(request, who);
  if (!found) {
    return std::move(found.error());
  }
  if (found->ending) {
    return std::move(*found->ending);
  }
  PendingRequest& withdrawn = *found->withdrawn;
  log.add(EventKind::RequestCancelled, name_of(withdrawn.request).str(), "by " + who);
  SwitchResult result = cancelled(withdrawn);
  result.outcome = Outcome::Cancelled;
  result.cancelled_by = who;
  result.from = result.runs = belief.controller().name;
  result.from_version = result.runs_version = belief.version();
  result.error =
      fail(ErrorCode::Cancelled, "cancelled by " + who + " before the request was served", result.to.str());
  journal.ended(std::as_const(result));
  std::promise<SwitchResult> told;
  told.set_value(result);
  answer(withdrawn, std::move(result));
  return told.get_future();
}

void Runtime::Implementation::cancel_requests_of(std::uint64_t lease, const std::string& who) {
  for (const std::uint64_t number : queue.open_with(lease)) {
    static_cast<void>(cancel(number, who));  // what is past its commit goes on to its end
  }
}

}  // namespace segue::runtime
