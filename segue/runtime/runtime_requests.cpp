// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/controller_names.hpp>
#include <segue/runtime/leftovers.hpp>
#include <segue/runtime/runtime_implementation.hpp>

#include <algorithm>
#include <utility>

namespace segue::runtime {

using detail::PendingRequest;

namespace {
constexpr std::size_t kKeptResults = 100;
/// Of texts and properties of an action, on average.
constexpr std::size_t kBytesOfTexts = 512;

std::size_t bytes_of(const SwitchResult& result) {
  const std::size_t actions = result.actions.size() + (result.undo ? result.undo->actions.size() : 0);
  return sizeof(SwitchResult) + actions * (sizeof(ActionRecord) + kBytesOfTexts);
}
}  // namespace

model::NetworkName detail::name_of(const Request& request) {
  struct Visitor {
    model::NetworkName operator()(const model::NetworkName& name) const { return name; }
    model::NetworkName operator()(const model::Network& network) const { return network.name; }
    model::NetworkName operator()(const model::Transition& transition) const { return transition.to; }
  };
  return std::visit(Visitor{}, request);
}

namespace {

using detail::name_of;

SwitchResult new_result(const PendingRequest& job) {
  SwitchResult result;
  result.request = job.number;
  result.who = job.options.who;
  result.time = std::chrono::system_clock::now();
  result.to = name_of(job.request);
  result.order = job.options.order;
  return result;
}

}  // namespace

AcceptedRequest Runtime::Implementation::accept(Request request, RequestOptions request_options) {
  if (auto* controller = std::get_if<model::NetworkName>(&request)) {
    *controller = model::joined_name(model::controllers_in(controller->str()));
  } else if (const auto* network = std::get_if<model::Network>(&request)) {
    journal.loaded(*network);
  }
  request_options.action_deadline = std::min(request_options.action_deadline, detail::kLongestDeadline);
  auto invalid = refusal_of_take_over(request, request_options);
  PendingRequest job{0, std::move(request), std::move(request_options), {}};
  std::future<SwitchResult> future = job.promise.get_future();
  job.parts = parts_of(job.request);
  std::optional<PendingRequest> older;
  std::uint64_t number = 0;
  {
    const Lock lock(mutex);
    number = job.number = ++requests;
    journal.accepted(job.number, job.options.who, name_of(job.request));
    if (auto refusal = refusal_of(job.options)) {
      invalid = detail::Refusal{std::move(*refusal), {}};
    }
    if (!invalid) {
      older = enqueue(std::move(job));
    }
  }
  if (invalid) {
    SwitchResult result = new_result(job);  // NOLINT(bugprone-use-after-move): only a valid one was moved
    result.from = result.runs = belief.controller().name;
    result.from_version = result.runs_version = belief.version();
    answer(job, refused(std::move(result), std::move(*invalid)));
    return {number, std::move(future)};
  }
  wake.notify_all();
  if (older) {
    log.add(EventKind::RequestSuperseded, name_of(older->request).str(),
            "request " + std::to_string(older->number) + " was superseded by a newer one");
    SwitchResult result = superseded(*older);
    journal.ended(std::as_const(result));
    answer(*older, std::move(result));
  }
  return {number, std::move(future)};
}

AcceptedRequest Runtime::Implementation::repair(RequestOptions request_options) {
  const auto held = belief.held();
  const bool unknown = !held.wanted && held.controller.name.empty() && !held.controller.empty();
  if (unknown) {
    PendingRequest job{0, model::NetworkName(), std::move(request_options), {}};
    AcceptedRequest refused_request{0, job.promise.get_future()};
    SwitchResult result =
        refused(new_result(job), {fail(ErrorCode::InvalidState,
                                       "what runs was not requested, so it is not known what "
                                       "to repair; `segue switch` to a controller"),
                                  {}});
    job.promise.set_value(std::move(result));
    return refused_request;
  }
  {
    const Lock lock(mutex);
    pools_begin_again = true;
  }
  if (held.wanted) {
    return accept(host.condensed(*held.wanted), std::move(request_options));
  }
  return accept(held.controller.name, std::move(request_options));
}

std::optional<PendingRequest> Runtime::Implementation::enqueue(PendingRequest job) {
  leases.take_over(job.options);
  if (!job.options.although_halted) {
    halts.forget();
  }
  log.add(EventKind::RequestAccepted, name_of(job.request).str(), "request " + std::to_string(job.number));
  auto older = std::exchange(waiting, std::move(job));
  if (transaction) {
    // What look-ahead prepares may be for a controller that nobody wants now.
    transaction_yields && waiting->parts ? transaction->make_way(*waiting->parts) : transaction->supersede();
  }
  return older;
}

/// A request that would take the robot over, and could not be carried out, takes it from nobody.
std::optional<detail::Refusal> Runtime::Implementation::refusal_of_take_over(
    const Request& request, const RequestOptions& request_options) const {
  if (!leases.would_take_over(request_options)) {
    return std::nullopt;
  }
  const auto plan = this->plan(belief.starting_point().network, request, request_options);
  return plan ? std::nullopt : std::optional(plan.error());
}

std::optional<Error> Runtime::Implementation::refusal_of_lost_robot() const {
  auto lost = host.loss();
  if (!lost) {
    return std::nullopt;
  }
  return fail(ErrorCode::Superseded,
              "this runtime has lost the robot, and does not get it back; end it, and start one with "
              "`segue run --take-over`",
              name)
      .because_of(std::move(*lost));
}

std::optional<Error> Runtime::Implementation::refusal_of(const RequestOptions& request_options) const {
  if (auto refusal = request_options.although_halted ? std::nullopt : halts.refusal()) {
    return refusal;
  }
  return leases.refusal_of(request_options);
}

Result<std::uint64_t> Runtime::Implementation::take_lease(std::string holder) {
  if (auto lost = refusal_of_lost_robot()) {
    return std::move(*lost);
  }
  const Lock lock(mutex);
  if (auto refusal = halts.refusal()) {
    return std::move(*refusal);
  }
  return leases.take(std::move(holder));
}

type::Value Runtime::Implementation::mission(std::uint64_t after, bool with_plan) {
  const Lock lock(mutex);
  return leases.mission(after, with_plan, halts.on_its_way().valid(), definitions.halt != nullptr);
}

SwitchResult Runtime::Implementation::serve(PendingRequest& job) {
  const TimePoint begin = RealClock::instance().now();
  SwitchResult result = new_result(job);
  pools_run = !job.options.end_pools;
  const auto [current, plan] = plan_from_now(job.request, job.options);
  result.from = current.network.name;
  result.from_version = belief.version();
  result.solve_time = RealClock::instance().now() - begin;
  if (!plan) {
    result.runs = result.from;
    result.runs_version = result.from_version;
    return refused(std::move(result), plan.error());
  }
  result.to_version = plan->controller.version;
  const auto held = belief.held();
  if (!belief.is_assumed()) {
    note_differences(current.network);
    adopt(current, held.controller, held.wanted);
  }
  carry_out(current.network, *plan, job.options.action_deadline, result, [&, &wanted = *plan] {
    if (job.at_commit) {
      adopt(belief.observe(), wanted.controller, wanted.controller);
      job.is_answered = true;
      job.promise.set_value(result);
    }
  });
  return result;
}

std::pair<detail::Observation, detail::Planned> Runtime::Implementation::plan_from_now(
    const Request& request, const RequestOptions& request_options) const {
  constexpr int kAttempts = 4;  // a computer that comes and goes all the time delays nobody for long
  for (int attempt = 1;; ++attempt) {
    const auto lost = detail::unreachable_hosts(host);
    auto current = belief.starting_point();
    current.network = left_actions->without_their_processes(std::move(current.network));
    auto plan = this->plan(current.network, request, request_options);
    if (!plan || plan->lost == lost || attempt == kAttempts) {
      return {std::move(current), std::move(plan)};
    }
  }
}

detail::Planned Runtime::Implementation::plan(const model::Network& current, const Request& request,
                                              const RequestOptions& request_options) const {
  if (request_options.action_deadline <= Duration::zero()) {
    return tl::unexpected(
        detail::Refusal{fail(ErrorCode::InvalidArgument, "the deadline of an action must be positive"), {}});
  }
  if (auto lost = request_options.although_halted ? std::nullopt : refusal_of_lost_robot()) {
    return tl::unexpected(detail::Refusal{std::move(*lost), {}});
  }
  if (const auto* transition = std::get_if<model::Transition>(&request)) {
    auto plan = detail::plan_transition(current, *transition, host, catalog);
    const auto same = plan ? known(plan->controller.name) : std::nullopt;
    if (same && equivalent(*same, plan->controller)) {
      plan->controller.version = same->version;
    }
    return plan;
  }
  if (!request_options.leaves_lost_hosts) {
    if (auto refusal = detail::refusal_for_unknown(belief.held().desired(), "the running controller", host)) {
      return tl::unexpected(std::move(*refusal));
    }
  }
  auto how = detail::solve_options(host, request_options.order, request_options.force);
  how.idle = detail::idle_tasks(current, belief.controller());
  const auto* given = std::get_if<model::Network>(&request);
  auto network =
      given != nullptr ? Result<model::Network>(*given) : resolve(std::get<model::NetworkName>(request));
  if (network) {
    network = detail::variant_of(std::move(*network), request_options.properties, catalog);
  }
  if (!network) {
    return tl::unexpected(detail::Refusal{std::move(network.error()), {}});
  }
  if (request_options.leaves_lost_hosts) {
    network = detail::reachable_part(*std::move(network), host);
  }
  if (auto refusal = refusal_for_pools(*network)) {
    return tl::unexpected(std::move(*refusal));
  }
  const detail::KeptNetworks beside{plan_ahead(host.expanded(*network)).standby, pool_part(current)};
  return detail::plan_network(current, std::move(*network), beside, host, catalog, std::move(how));
}

std::optional<detail::NetworkParts> Runtime::Implementation::parts_of(const Request& request) const {
  const auto* given = std::get_if<model::Network>(&request);
  const auto* named = std::get_if<model::NetworkName>(&request);
  const auto network = given != nullptr   ? std::optional(*given)
                       : named != nullptr ? known(*named)
                                          : std::nullopt;
  if (!network && (named == nullptr || !named->empty())) {
    return std::nullopt;
  }
  detail::NetworkParts parts;
  parts.add(network ? host.expanded(*network) : model::Network());
  return parts;
}

Result<model::Network> Runtime::Implementation::resolve(const model::NetworkName& wanted) const {
  const Lock lock(mutex);
  return find_controller(definitions.controllers, wanted, catalog);
}

Result<std::vector<ControllerConflict>> Runtime::Implementation::conflicts(
    const std::vector<model::NetworkName>& names) const {
  std::vector<model::Network> networks;
  for (const auto& wanted : names) {
    auto network = resolve(wanted);
    if (!network) {
      return std::move(network.error());
    }
    networks.push_back(std::move(*network));
  }
  std::vector<ControllerConflict> all;
  for (std::size_t i = 0; i < networks.size(); ++i) {
    for (std::size_t j = i + 1; j < networks.size(); ++j) {
      for (auto& conflict : solve::conflicts(networks[i], networks[j], catalog)) {
        all.push_back({networks[i].name, networks[j].name, std::move(conflict)});
      }
    }
    for (const auto& other : networks) {
      for (auto& influence : solve::influences(networks[i], other)) {
        all.push_back({networks[i].name, other.name, std::move(influence), true});
      }
    }
  }
  return all;
}

void Runtime::Implementation::answer(PendingRequest& job, SwitchResult result) {
  remember(result);
  if (!job.is_answered) {
    job.promise.set_value(std::move(result));
  }
}

void Runtime::Implementation::remember(SwitchResult result) {
  const Lock lock(mutex);
  if (served && served->number == result.request) {
    for (auto& promise : served->cancelled) {
      promise.set_value(result);
    }
    served.reset();
  }
  history.push_back(std::move(result));
  std::size_t bytes = 0;
  for (const auto& kept : history) {
    bytes += bytes_of(kept);
  }
  while (history.size() > kKeptResults || (bytes > options.kept_bytes && history.size() > 1)) {
    bytes -= bytes_of(history.front());
    history.pop_front();
  }
}

SwitchResult Runtime::Implementation::superseded(const PendingRequest& job) const {
  SwitchResult result = new_result(job);
  result.outcome = Outcome::Superseded;
  result.error = fail(ErrorCode::Superseded, "a newer request took its place", result.to.str());
  return result;
}

SwitchResult Runtime::Implementation::cancelled(const PendingRequest& job) const {
  SwitchResult result = new_result(job);
  result.outcome = Outcome::Refused;
  result.error =
      fail(ErrorCode::Cancelled, "the runtime ended before the request was served", result.to.str());
  return result;
}

SwitchResult Runtime::Implementation::refused(SwitchResult result, detail::Refusal refusal) {
  result.outcome = Outcome::Refused;
  result.error = std::move(refusal.error);
  result.diagnostics = std::move(refusal.diagnostics);
  log.add(EventKind::RequestRefused, result.to.str(), to_string(*result.error));
  journal.ended(std::as_const(result));
  return result;
}

}  // namespace segue::runtime
