// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/component.hpp>
#include <segue/model/network.hpp>
#include <segue/model/robot.hpp>
#include <segue/runtime/runtime.hpp>

#include <functional>
#include <vector>

namespace segue::runtime::detail {

/// A controller that is to be kept ready; they come the likeliest first.
struct Wish {
  model::NetworkName name;
  std::optional<model::Network> network;  ///< nothing: nobody knows such a controller
};

/// What is to stand beside a controller so that others are ready.
struct LookAheadPlan {
  model::Network beside;
  std::vector<Readiness> readiness;  ///< one for each wish, as it will be
};

/// How much memory (bytes) a process takes that stands beside now; 0: not known.
using MemoryOf = std::function<std::uint64_t(const model::DeploymentKey& process)>;

/// As much of the wishes as the budget permits, in their order, and of each its processes in theirs. Pure but
/// for `memory_of`.
LookAheadPlan look_ahead(const model::Network& controller, const std::vector<Wish>& wishes,
                         const model::ComponentCatalog& catalog, const model::LookAhead& budget,
                         const MemoryOf& memory_of);

/// What of `beside` is there already in `current`, running or not: it can stay where it is.
model::Network already_there(const model::Network& beside, const model::Network& current);

}  // namespace segue::runtime::detail
