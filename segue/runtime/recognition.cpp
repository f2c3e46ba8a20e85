// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/recognition.hpp>

#include <segue/model/network_sets.hpp>
#include <segue/runtime/look_ahead.hpp>
#include <segue/solve/combine.hpp>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

namespace segue::runtime::detail {

namespace {

/// The union of all that are a part of the network, if that is the network.
std::optional<model::Network> whole_of(const std::vector<model::Network>& parts,
                                       const model::Network& observed,
                                       const model::ComponentCatalog& catalog) {
  auto all = solve::combine(parts, catalog);
  if (!all || !equivalent(observed, *all)) return std::nullopt;
  return std::move(*all);
}

/// The network that is, once the controllers' tasks have the properties that are observed.
std::optional<model::Network> adapted_controller(const model::Network& observed,
                                                 const Controllers& controllers,
                                                 const model::ComponentCatalog& catalog) {
  std::vector<model::Network> parts;
  for (const auto& [name, defined] : controllers) {
    model::Network adapted = with_properties_of(observed, defined);
    if (defined.empty() || !model::includes(observed, adapted)) continue;
    const bool is_ambiguous =
        std::ranges::any_of(parts, [&](const model::Network& other) { return equivalent(other, adapted); });
    if (is_ambiguous) return std::nullopt;
    if (!equivalent(adapted, defined)) adapted.version.clear();
    parts.push_back(std::move(adapted));
  }
  const auto alone =
      std::ranges::find_if(parts, [&](const model::Network& one) { return equivalent(observed, one); });
  return alone != parts.end() ? std::optional(std::move(*alone)) : whole_of(parts, observed, catalog);
}

/// The network without the tasks that do not run.
model::Network running_part(const model::Network& observed) {
  std::set<model::TaskId> idle;
  model::Network rest;
  rest.deployments = observed.deployments;
  for (const model::Task& task : observed.tasks) {
    if (task.state == TaskState::Running) continue;
    idle.insert(task.id);
    rest.tasks.push_back(task);
  }
  for (const model::Connection& connection : observed.connections) {
    if (idle.contains(connection.from.task) || idle.contains(connection.to.task))
      rest.connections.push_back(connection);
  }
  return idle.empty() ? observed : model::subtract(observed, rest);
}

}  // namespace

model::NetworkName name_of(const model::Network& observed, const Controllers& controllers,
                           const model::ComponentCatalog& catalog) {
  std::vector<model::Network> parts;
  for (const auto& [name, network] : controllers) {
    if (equivalent(observed, network)) return name;
    if (!network.empty() && model::includes(observed, network)) parts.push_back(network);
  }
  const auto all = whole_of(parts, observed, catalog);
  return all ? all->name : model::NetworkName{};
}

std::optional<model::Network> running_controller(const model::Network& observed,
                                                 const Controllers& controllers,
                                                 const model::ComponentCatalog& catalog) {
  for (const model::Network& seen : {observed, running_part(observed)}) {
    if (seen.empty()) continue;
    if (const auto name = name_of(seen, controllers, catalog); !name.empty()) {
      if (auto found = find_controller(controllers, name, catalog)) return std::move(*found);
    }
    if (auto adapted = adapted_controller(seen, controllers, catalog)) return adapted;
  }
  return std::nullopt;
}

}  // namespace segue::runtime::detail
