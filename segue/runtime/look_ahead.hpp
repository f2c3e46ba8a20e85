// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>
#include <segue/model/robot.hpp>
#include <segue/runtime/process_memory.hpp>
#include <segue/runtime/runtime.hpp>

#include <vector>

namespace segue::runtime::detail {

/// A controller to be kept on standby. Requests are ordered by likelihood, the likeliest first.
struct PrepareRequest {
  model::NetworkName name;
  std::optional<model::Network> network;  ///< nothing: there is no controller of that name
  bool always = false;                    ///< whatever the budget is; not among the readiness
};

/// The standby network for a controller.
struct LookAheadPlan {
  model::Network standby;
  std::vector<Readiness> readiness;  ///< one for each request, once `standby` is in place
};

/// Plans as much of the requests as the budget permits: requests in their order, and the processes of each in
/// the order of its network. Pure except for `memory_of`.
LookAheadPlan look_ahead(const model::Network& controller,
                         const std::vector<PrepareRequest>& requests_to_prepare,
                         const model::ComponentCatalog& catalog, const model::LookAhead& budget,
                         const MemoryOf& memory_of);

/// The parts of `standby` that exist in `current`, running or not, and can stay as they are.
model::Network already_present(const model::Network& standby, const model::Network& current);

/// `controller` with the properties that its tasks have in `seen`: users may set properties of a running
/// controller, and look-ahead leaves them as they are.
model::Network with_properties_of(const model::Network& seen, model::Network controller);

}  // namespace segue::runtime::detail
