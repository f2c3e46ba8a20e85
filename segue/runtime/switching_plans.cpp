// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/leftovers.hpp>
#include <segue/runtime/switching.hpp>

#include <utility>
#include <variant>

/// The plans of Switching.
namespace segue::runtime::detail {

std::pair<Observation, Result<SwitchPlan>> Switching::plan_from_now(const Request& request,
                                                                    const RequestOptions& options,
                                                                    const Privileges& privileges) const {
  constexpr int kAttempts = 4;  // a computer that comes and goes all the time delays nobody for long
  for (int attempt = 1;; ++attempt) {
    const auto lost = unreachable_hosts(parts_.host);
    auto current = parts_.belief.starting_point();
    current.network = parts_.queue.left_actions()->without_their_processes(std::move(current.network));
    auto plan = this->plan(current.network, request, options, privileges);
    if (!plan || plan->lost == lost || attempt == kAttempts) {
      return {std::move(current), std::move(plan)};
    }
  }
}

std::optional<Error> Switching::refusal_of(const RequestOptions& options,
                                           const Privileges& privileges) const {
  if (options.action_deadline <= Duration::zero()) {
    return fail(ErrorCode::InvalidArgument, "the deadline of an action must be positive");
  }
  return privileges.although_halted ? std::nullopt : parts_.refusal_of_lost_robot();
}

Result<SwitchPlan> Switching::plan_given(const model::Network& current,
                                         const model::Transition& transition) const {
  auto plan = plan_transition(current, transition, parts_.host, parts_.catalog);
  const auto same = plan ? parts_.controllers.known(plan->controller.name) : std::nullopt;
  if (same && equivalent(*same, plan->controller)) {
    plan->controller.version = same->version;
  }
  return plan;
}

Result<model::Network> Switching::requested_network(const Request& request, const RequestOptions& options,
                                                    const Privileges& privileges) const {
  const auto* given = std::get_if<model::Network>(&request);
  auto network = given != nullptr ? Result<model::Network>(*given)
                                  : parts_.controllers.find(std::get<model::NetworkName>(request));
  if (network) {
    network = variant_of(std::move(*network), options.properties, parts_.catalog);
  }
  if (network && privileges.leaves_lost_hosts) {
    network = reachable_part(*std::move(network), parts_.host);
  }
  return network;
}

Result<SwitchPlan> Switching::plan(const model::Network& current, const Request& request,
                                   const RequestOptions& options, const Privileges& privileges) const {
  if (auto refusal = refusal_of(options, privileges)) {
    return std::move(*refusal);
  }
  if (const auto* transition = std::get_if<model::Transition>(&request)) {
    return plan_given(current, *transition);
  }
  if (!privileges.leaves_lost_hosts) {
    const auto runs = parts_.belief.held().desired();
    if (auto refusal = refusal_for_unknown(runs, "the running controller", parts_.host)) {
      return std::move(*refusal);
    }
  }
  auto network = requested_network(request, options, privileges);
  if (!network) {
    return std::move(network.error());
  }
  if (auto refusal = parts_.pools.refusal_for(*network)) {
    return std::move(*refusal);
  }
  auto how = solve_options(parts_.host, options.order, options.force);
  how.idle = idle_tasks(current, parts_.belief.controller());
  const KeptNetworks beside{parts_.standby_requests.plan(parts_.host.expanded(*network)).standby,
                            parts_.pools.part(current), privileges.leaves_faulty};
  return plan_network(current, std::move(*network), beside, parts_.host, parts_.catalog, std::move(how));
}

std::optional<NetworkParts> Switching::parts_of(const Request& request) const {
  const auto* given = std::get_if<model::Network>(&request);
  const auto* named = std::get_if<model::NetworkName>(&request);
  const auto network = given != nullptr   ? std::optional(*given)
                       : named != nullptr ? parts_.controllers.known(*named)
                                          : std::nullopt;
  if (!network && (named == nullptr || !named->empty())) {
    return std::nullopt;
  }
  NetworkParts parts;
  parts.add(network ? parts_.host.expanded(*network) : model::Network());
  return parts;
}

}  // namespace segue::runtime::detail
