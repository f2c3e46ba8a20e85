// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/host/task_host.hpp>
#include <segue/model/component.hpp>
#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/solve/solve.hpp>

#include <string>

namespace segue::runtime::detail {

/// What a request comes down to: what is to run, and the way there.
struct Plan {
  model::Network controller;  ///< as it was requested
  model::Network target;      ///< and what stays beside it
  model::Transition transition;
};

/// Why a request is refused: the error, and all findings where there are several.
struct Refusal {
  Error error;
  Diagnostics diagnostics;
};

/// What the solver may use on this host.
solve::Options solve_options(const host::TaskHost& host, model::Order order, bool force);

/// Validates `controller` as deeply as the host needs it and computes the way from `current`; what of `keep`
/// is there already stays beside it.
tl::expected<Plan, Refusal> plan_network(const model::Network& current, model::Network controller,
                                         const model::Network& keep, const host::TaskHost& host,
                                         const model::ComponentCatalog& catalog,
                                         const solve::Options& options);

/// A transition as it is given: what it leads to, after the same validation.
tl::expected<Plan, Refusal> plan_transition(const model::Network& current, model::Transition transition,
                                            const host::TaskHost& host,
                                            const model::ComponentCatalog& catalog);

/// Findings that keep `network` from running on `host`, warnings included.
Diagnostics check_runnable(const model::Network& network, const host::TaskHost& host,
                           const model::ComponentCatalog& catalog);

/// "3 tasks (2 running, 1 stopped), 4 connections, 1 deployment": what a robot runs, for messages.
std::string summary(const model::Network& network);

/// "'goal_navigation'", or "the empty network".
std::string shown(const model::NetworkName& name);

}  // namespace segue::runtime::detail
