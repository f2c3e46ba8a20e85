// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/controller_registry.hpp>

#include <segue/base/text.hpp>
#include <segue/runtime/planning.hpp>
#include <segue/runtime/recognition.hpp>
#include <segue/solve/combine.hpp>

#include <utility>

namespace segue::runtime::detail {

namespace {

/// The halt of `set`; `before`, where it is equal, so that nobody begins to watch its conditions anew.
std::shared_ptr<const model::Halt> halt_of(const ControllerSet& set,
                                           const std::shared_ptr<const model::Halt>& before) {
  if (!set.halt) {
    return nullptr;
  }
  return before && *before == *set.halt ? before : std::make_shared<const model::Halt>(*set.halt);
}

}  // namespace

ControllerRegistry::ControllerRegistry(const task_host::TaskHost& host,
                                       const model::ComponentCatalog& catalog,
                                       std::optional<model::NetworkName> fallback,
                                       const std::optional<model::Halt>& halt)
    : host_(host), catalog_(catalog) {
  now_.fallback = std::move(fallback);
  now_.halt = halt ? std::make_shared<const model::Halt>(*halt) : nullptr;
}

void ControllerRegistry::add(model::Network controller) {
  const Lock lock(mutex_);
  now_.loaded.erase(controller.name);
  model::NetworkName name = controller.name;
  now_.controllers.insert_or_assign(std::move(name), std::move(controller));
}

Definitions ControllerRegistry::replace(const ControllerSet& set) {
  const Lock lock(mutex_);
  return std::exchange(now_, with(set));
}

void ControllerRegistry::restore(Definitions before) {
  const Lock lock(mutex_);
  now_ = std::move(before);
}

Result<model::Network> ControllerRegistry::find(const model::NetworkName& name) const {
  const Lock lock(mutex_);
  return find_controller(now_.controllers, name, catalog_);
}

std::optional<model::Network> ControllerRegistry::known(const model::NetworkName& name) const {
  if (name.empty()) {
    return std::nullopt;
  }
  auto found = find(name);
  return found ? std::optional(std::move(*found)) : std::nullopt;
}

std::optional<model::Network> ControllerRegistry::expanded(const model::NetworkName& name) const {
  auto network = known(name);
  return network ? std::optional(host_.expanded(*std::move(network))) : std::nullopt;
}

std::optional<model::Network> ControllerRegistry::fallback() const {
  const auto name = fallback_name();
  return name ? known(*name) : std::nullopt;
}

std::optional<model::NetworkName> ControllerRegistry::fallback_name() const {
  const Lock lock(mutex_);
  return now_.fallback;
}

std::shared_ptr<const model::Halt> ControllerRegistry::halt() const {
  const Lock lock(mutex_);
  return now_.halt;
}

std::vector<model::NetworkName> ControllerRegistry::names() const {
  const Lock lock(mutex_);
  std::vector<model::NetworkName> names;
  for (const auto& [name, controller] : now_.controllers) {
    names.push_back(name);
  }
  return names;
}

std::vector<LoadedFile> ControllerRegistry::files() const {
  const Lock lock(mutex_);
  return now_.files;
}

std::vector<std::string> ControllerRegistry::transitions() const {
  const Lock lock(mutex_);
  std::vector<std::string> names;
  for (const auto& [name, transition] : now_.transitions) {
    names.push_back(name);
  }
  return names;
}

Result<model::Transition> ControllerRegistry::transition(const std::string& name) const {
  const auto names = transitions();
  const Lock lock(mutex_);
  const auto found = now_.transitions.find(name);
  if (found == now_.transitions.end()) {
    return fail(ErrorCode::NotFound,
                "the robot has no transition " + quote(name) + did_you_mean(name, names));
  }
  return found->second;
}

Diagnostics ControllerRegistry::check(const ControllerSet& set) const {
  Diagnostics findings;
  for (const auto& network : set.controllers) {
    findings.append(check_runnable(network, host_, catalog_));
  }
  return findings;
}

std::vector<ControllerChange> ControllerRegistry::compare(const ControllerSet& set,
                                                          const model::NetworkName& runs) const {
  const Lock lock(mutex_);
  return runtime::compare(now_.controllers, with(set).controllers, runs);
}

std::vector<ControllerChange> ControllerRegistry::changes_since(const Definitions& before,
                                                                const model::NetworkName& runs) const {
  const Lock lock(mutex_);
  return runtime::compare(before.controllers, now_.controllers, runs);
}

Result<std::vector<ControllerConflict>> ControllerRegistry::conflicts(
    const std::vector<model::NetworkName>& names) const {
  std::vector<model::Network> networks;
  for (const auto& wanted : names) {
    auto network = find(wanted);
    if (!network) {
      return std::move(network.error());
    }
    networks.push_back(std::move(*network));
  }
  std::vector<ControllerConflict> all;
  for (std::size_t i = 0; i < networks.size(); ++i) {
    for (std::size_t j = i + 1; j < networks.size(); ++j) {
      for (auto& conflict : solve::conflicts(networks[i], networks[j], catalog_)) {
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

model::NetworkName ControllerRegistry::name_of(const model::Network& condensed) const {
  const Lock lock(mutex_);
  return detail::name_of(condensed, now_.controllers, catalog_);
}

std::optional<model::Network> ControllerRegistry::running_controller(const model::Network& condensed) const {
  const Lock lock(mutex_);
  return detail::running_controller(condensed, now_.controllers, catalog_);
}

Definitions ControllerRegistry::with(const ControllerSet& set) const {
  Definitions all{now_.controllers, {}, set.fallback, halt_of(set, now_.halt), {}, set.files};
  for (const auto& name : now_.loaded) {
    all.controllers.erase(name);
  }
  for (const auto& network : set.controllers) {
    all.loaded.insert(network.name);
    all.controllers.insert_or_assign(network.name, network);
  }
  for (const auto& transition : set.transitions) {
    all.transitions.insert_or_assign(transition.name, transition);
  }
  return all;
}

}  // namespace segue::runtime::detail
