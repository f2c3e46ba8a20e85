// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/solve/solve.hpp>
#include <segue/task_host/task_host.hpp>

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace segue::runtime::detail {

/// The target of a request and the transition to it.
struct SwitchPlan {
  model::Network controller;  ///< the requested controller
  model::Network target;      ///< the controller, and the standby parts that stay
  model::Transition transition;
  /// Computers that could not be reached. Nothing there is part of the target, or touched.
  std::set<model::HostName> lost{};
};

/// Computers that cannot be reached now.
std::set<model::HostName> unreachable_hosts(const task_host::TaskHost& host);
/// The network without what is on computers that cannot be reached now: tasks there, their connections and
/// processes.
model::Network reachable_part(model::Network network, const task_host::TaskHost& host);
/// Why a request is refused before anything changes: a computer that `network` uses cannot be reached and is
/// not optional. `role` begins the message: "the running controller".
std::optional<Error> refusal_for_unknown(const model::Network& network, std::string_view role,
                                         const task_host::TaskHost& host);

/// Options of the solver for this host.
solve::Options solve_options(const task_host::TaskHost& host, model::Order order, bool force);

/// solve::diff() from an observed network: incarnations that an earlier request left where `target` places
/// their tasks are used.
Result<model::Transition> solve_from_observed(const model::Network& current, const model::Network& target,
                                              const model::ComponentCatalog& catalog, solve::Options options);

/// The network with these properties in place of its own. NotFound where it has no such task; InvalidArgument
/// for a member ("speed.max") of a property whose other members are not known here.
Result<model::Network> variant_of(model::Network network, const std::vector<PropertySetting>& properties,
                                  const model::ComponentCatalog& catalog);

/// Tasks that a transition leaves as they are.
struct KeptNetworks {
  model::Network keep{};   ///< beside the controller: those parts of it that exist
  model::Network pools{};  ///< beside the controller: parts of the present network
  /// Tasks of the controller that are in an error state are not repaired. Those that are to be stopped are
  /// stopped, unless they are in Exception, where nothing runs.
  bool leaves_faulty = false;
};

/// Validates `controller` to the depth that the host requires and solves from `current`.
Result<SwitchPlan> plan_network(const model::Network& current, model::Network controller,
                                const KeptNetworks& beside, const task_host::TaskHost& host,
                                const model::ComponentCatalog& catalog, solve::Options options);

/// Predicts the network that a given transition leads to, and validates it in the same way.
Result<SwitchPlan> plan_transition(const model::Network& current, model::Transition transition,
                                   const task_host::TaskHost& host, const model::ComponentCatalog& catalog);

/// All findings about running `network` on `host`, warnings included.
Diagnostics check_runnable(const model::Network& network, const task_host::TaskHost& host,
                           const model::ComponentCatalog& catalog);

/// "3 tasks (2 running, 1 stopped), 4 connections, 1 deployment", for messages.
std::string summary(const model::Network& network);

/// "'goal_navigation'", or "the empty network", for messages.
std::string quoted_name(const model::NetworkName& name);

}  // namespace segue::runtime::detail
