// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/planning.hpp>

#include <segue/base/text.hpp>
#include <segue/model/network_sets.hpp>
#include <segue/model/validate.hpp>
#include <segue/runtime/leftovers.hpp>
#include <segue/runtime/look_ahead.hpp>

#include <algorithm>
#include <array>
#include <map>
#include <set>

namespace segue::runtime::detail {

namespace {

std::optional<Error> refusal_for(const model::Network& network, const task_host::TaskHost& host,
                                 const model::ComponentCatalog& catalog) {
  Diagnostics findings = check_runnable(network, host, catalog);
  if (!findings.has_errors()) {
    return std::nullopt;
  }
  Error error = findings.to_error();
  error.subject = network.name.str();
  return error;
}

/// The property as the task would have it without the setting: of its network, or its component's default.
const type::Value* property_before(const model::Task& task, const std::string& name,
                                   const model::ComponentCatalog& catalog) {
  if (const auto* found = task.properties.find(name)) {
    return found;
  }
  const model::ComponentModel* component = catalog.find(task.component);
  const auto* property = component == nullptr ? nullptr : component->find_property(name);
  return property == nullptr || !task.config_names.empty() ? nullptr : &property->default_value;
}

Result<void> set_member(model::Task& task, const PropertySetting& setting,
                        const model::ComponentCatalog& catalog) {
  const std::string name = setting.property.substr(0, setting.property.find('.'));
  if (name == setting.property) {
    task.properties.as_map().set(name, setting.value);
    return {};
  }
  const auto* before = property_before(task, name, catalog);
  type::Value all = before == nullptr ? type::Value() : *before;
  type::Value* member = &all;
  for (std::size_t at = name.size(); at < setting.property.size();) {
    const std::size_t end = std::min(setting.property.find('.', at + 1), setting.property.size());
    member =
        member->is_map() ? member->as_map().find(setting.property.substr(at + 1, end - at - 1)) : nullptr;
    if (member == nullptr) {
      return fail(ErrorCode::InvalidArgument, "property " + quote(name) + " of task " + quote(task.id.str()) +
                                                  " is not known to have " + quote(setting.property) +
                                                  "; give the whole property");
    }
    at = end;
  }
  *member = setting.value;
  task.properties.as_map().set(name, std::move(all));
  return {};
}

}  // namespace

Diagnostics check_runnable(const model::Network& network, const task_host::TaskHost& host,
                           const model::ComponentCatalog& catalog) {
  Diagnostics findings = model::validate(
      network, catalog, [&](const model::ComponentName& component) { return host.stands_in(component); });
  std::set<model::ComponentName> seen;
  for (const auto& task : network.tasks) {
    if (!seen.insert(task.component).second || catalog.find(task.component) == nullptr) {
      continue;  // validation has reported unknown components, if the host needs them to be known
    }
    if (auto possible = host.can_make(task.component); !possible) {
      findings.error("not-installed", possible.error().message, task.where);
    }
  }
  findings.append(host.check(network));
  findings.sort();
  return findings;
}

std::set<model::HostName> unreachable_hosts(const task_host::TaskHost& host) {
  std::set<model::HostName> hosts;
  for (const auto& computer : host.computers()) {
    if (!computer.reachable) {
      hosts.insert(computer.name);
    }
  }
  return hosts;
}

model::Network reachable_part(model::Network network, const task_host::TaskHost& host) {
  const auto lost = unreachable_hosts(host);
  return lost.empty() ? std::move(network) : without_hosts(std::move(network), lost);
}

std::optional<Error> refusal_for_unknown(const model::Network& network, std::string_view role,
                                         const task_host::TaskHost& host) {
  for (const auto& computer : host.computers()) {
    const bool used =
        std::any_of(network.deployments.begin(), network.deployments.end(),
                    [&](const model::Deployment& deployment) { return deployment.host == computer.name; });
    if (used && !computer.reachable && !computer.optional) {
      return fail(ErrorCode::Unavailable,
                  std::string(role) + " has tasks on host " + quote(computer.name.str()) +
                      ", which cannot be reached (" + computer.state +
                      "), so what runs there is unknown; nothing has changed. Once the host is back, "
                      "try again; or say in the robot file that it is 'optional'");
    }
  }
  return std::nullopt;
}

solve::Options solve_options(const task_host::TaskHost& host, model::Order order, bool force) {
  return {order, host.side_by_side(), force};
}

Result<model::Transition> solve_from_observed(const model::Network& current, const model::Network& target,
                                              const model::ComponentCatalog& catalog,
                                              solve::Options options) {
  options.prepared = prepared_incarnations(current, target);
  return solve::diff(current, target, catalog, options);
}

Result<model::Network> variant_of(model::Network network, const std::vector<PropertySetting>& properties,
                                  const model::ComponentCatalog& catalog) {
  for (const auto& setting : properties) {
    model::Task* task = network.find_task(setting.task);
    if (task == nullptr) {
      std::vector<std::string> ids;
      for (const auto& known : network.tasks) {
        ids.push_back(known.id.str());
      }
      return fail(ErrorCode::NotFound, quoted_name(network.name) + " has no task " +
                                           quote(setting.task.str()) + did_you_mean(setting.task.str(), ids));
    }
    if (auto set = set_member(*task, setting, catalog); !set) {
      return std::move(set.error());
    }
  }
  return network;
}

namespace {

/// Tasks in error states, but for those that are to be stopped, are wanted as they are. What shares its
/// process with a task in Fatal that is to be stopped is created again with that process, and comes no
/// further.
void leave_faulty(model::Network& target, const model::Network& current) {
  const model::TaskIndex now(current);
  const auto processes = model::task_processes(current);
  const auto process_of = [&](const model::TaskId& task) {
    const auto found = processes.find(task);
    return found == processes.end() ? model::DeploymentKey{} : found->second;
  };
  std::set<model::DeploymentKey> replaced;
  for (const auto& task : target.tasks) {
    const auto* is = now.find(task.id);
    if (is != nullptr && is->state == TaskState::Fatal && task.state == TaskState::Stopped) {
      replaced.insert(process_of(task.id));
    }
  }
  for (auto& task : target.tasks) {
    const auto* is = now.find(task.id);
    if (is == nullptr || !is_error(is->state)) {
      continue;
    }
    const bool is_to_be_stopped = task.state == TaskState::Stopped && is->state != TaskState::Exception;
    if (replaced.contains(process_of(task.id))) {
      task.state = TaskState::PreOperational;
    } else if (!is_to_be_stopped) {
      task = *is;
    }
  }
}

}  // namespace

Result<SwitchPlan> plan_network(const model::Network& current, model::Network controller,
                                const KeptNetworks& beside, const task_host::TaskHost& host,
                                const model::ComponentCatalog& catalog, solve::Options options) {
  if (auto refusal = refusal_for(host.condensed(controller), host, catalog)) {
    return std::move(*refusal);
  }
  controller = host.expanded(std::move(controller));
  if (auto refusal = refusal_for_unknown(controller, quoted_name(controller.name), host)) {
    return std::move(*refusal);
  }
  if (beside.leaves_faulty) {
    leave_faulty(controller, current);
  }
  auto lost = unreachable_hosts(host);
  model::Network target = unite(without_hosts(controller, lost), already_present(beside.keep, current));
  target = unite(std::move(target), beside.pools);
  auto transition = solve_from_observed(current, target, catalog, std::move(options));
  if (!transition) {
    return std::move(transition.error());
  }
  return SwitchPlan{std::move(controller), std::move(target), std::move(*transition), std::move(lost)};
}

Result<SwitchPlan> plan_transition(const model::Network& current, model::Transition transition,
                                   const task_host::TaskHost& host, const model::ComponentCatalog& catalog) {
  auto target = solve::predict(current, transition, catalog);
  if (!target) {
    return fail(ErrorCode::InvalidArgument,
                "the transition cannot be applied to the running network (" + summary(current) + ")",
                transition.to.str())
        .because_of(std::move(target.error()));
  }
  target->name = transition.to;
  if (auto refusal = refusal_for(*target, host, catalog)) {
    return std::move(*refusal);
  }
  return SwitchPlan{*target, *target, std::move(transition), unreachable_hosts(host)};
}

std::string quoted_name(const model::NetworkName& name) {
  return name.empty() ? "the empty network" : quote(name.str());
}

std::string summary(const model::Network& network) {
  if (network.empty()) {
    return "nothing";
  }
  std::array<std::size_t, kTaskStateNames.size()> by_state{};
  for (const auto& task : network.tasks) {
    ++by_state.at(static_cast<std::size_t>(task.state));
  }
  std::vector<std::string> states;
  for (std::size_t state = 0; state < by_state.size(); ++state) {
    if (by_state.at(state) > 0) {
      states.push_back(std::to_string(by_state.at(state)) + ' ' + std::string(kTaskStateNames.at(state)));
    }
  }
  std::string text = counted(network.tasks.size(), "task");
  if (!states.empty()) {
    text += " (" + listed(states) + ")";
  }
  return text + ", " + counted(network.connections.size(), "connection") + ", " +
         counted(network.deployments.size(), "deployment");
}

}  // namespace segue::runtime::detail
