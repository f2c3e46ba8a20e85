// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/halt_parts.hpp>
#include <segue/model/network_index.hpp>
#include <segue/model/pools.hpp>
#include <segue/model/validate.hpp>

#include <algorithm>
#include <set>
#include <unordered_map>

namespace segue::model {
namespace {

std::vector<std::string> host_names(const Robot& robot) {
  std::vector<std::string> names{kLocalHost.str()};
  for (const Host& host : robot.hosts)
    names.push_back(host.name.str());
  return names;
}

void check_hosts(const Robot& robot, Diagnostics& diagnostics) {
  std::set<HostName> seen;
  for (const Host& host : robot.hosts) {
    if (!seen.insert(host.name).second) {
      diagnostics.error("duplicate-host", "host " + quote(host.name.str()) + " is defined twice",
                        robot.where);
    }
  }
}

void check_fallback(const Robot& robot, const std::vector<Network>& networks, Diagnostics& diagnostics) {
  if (!robot.fallback) return;
  std::vector<std::string> names;
  names.reserve(networks.size());
  for (const Network& network : networks)
    names.push_back(network.name.str());
  if (std::ranges::find(names, robot.fallback->str()) != names.end()) return;
  diagnostics.error("unknown-controller",
                    "the fallback " + quote(robot.fallback->str()) + " is none of the robot's controllers" +
                        did_you_mean(robot.fallback->str(), names),
                    robot.where);
}

void check_network_hosts(const Robot& robot, const Network& network, Diagnostics& diagnostics) {
  const std::vector<std::string> names = host_names(robot);
  for (const Deployment& deployment : network.deployments) {
    if (std::ranges::find(names, deployment.host.str()) != names.end()) continue;
    diagnostics.error("unknown-host",
                      "process " + to_string(deployment.key()) + ": the robot has no host " +
                          quote(deployment.host.str()) + did_you_mean(deployment.host.str(), names),
                      detail::place(deployment.where, network));
  }
}

/// The failure policy `fallback` requires a fallback controller.
void check_fallback_users(const Robot& robot, const Network& network, Diagnostics& diagnostics) {
  if (robot.fallback) return;
  const auto check = [&](const auto& user, const std::string& what) {
    if (user.on_failure != FailurePolicy::Fallback) return;
    diagnostics.error("no-fallback",
                      what + ": 'on_failure: fallback' needs the robot's 'fallback' controller, which " +
                          quote(robot.name) + " does not name",
                      detail::place(user.where, network));
  };
  for (const Task& task : network.tasks)
    check(task, "task " + quote(task.id.str()));
  for (const Deployment& deployment : network.deployments)
    check(deployment, "process " + to_string(deployment.key()));
}

}  // namespace

Diagnostics validate(const Network& network, const ComponentCatalog& catalog, Depth depth) {
  Diagnostics diagnostics;
  const detail::NetworkIndex index(network, catalog);
  detail::check_structure(network, index, diagnostics);
  if (depth == Depth::Full) detail::check_components(network, index, catalog, {}, diagnostics);
  diagnostics.sort();
  return diagnostics;
}

Diagnostics validate(const Network& network, const ComponentCatalog& catalog, const StandsIn& stands_in) {
  Diagnostics diagnostics;
  const detail::NetworkIndex index(network, catalog);
  detail::check_structure(network, index, diagnostics);
  detail::check_components(network, index, catalog, stands_in, diagnostics);
  diagnostics.sort();
  return diagnostics;
}

Diagnostics validate_references(const Network& parts, const ComponentCatalog& catalog, Depth depth) {
  static const std::set<std::string_view> kCodes = {
      "unknown-task",   "unknown-component", "abstract-component", "unknown-port",
      "type-mismatch",  "unknown-property",  "wrong-direction",    "task-in-two-deployments",
      "duplicate-task", "duplicate-process", "unknown-placement",  "duplicate-connection"};
  Diagnostics diagnostics;
  if (parts.tasks.empty()) return diagnostics;  // nothing is left that could be referred to
  const Diagnostics found = validate(parts, catalog, depth);
  for (const Diagnostic& item : found.items()) {
    if (kCodes.contains(item.code)) diagnostics.add(item);
  }
  return diagnostics;
}

void check_names(const std::vector<Transition>& transitions, Diagnostics& diagnostics) {
  std::unordered_map<std::string, const Transition*> seen;
  for (const Transition& transition : transitions) {
    const auto [first, fresh] = seen.try_emplace(transition.name, &transition);
    if (fresh) continue;
    diagnostics.error("duplicate-transition",
                      "two transitions are named " + quote(transition.name) + "; the other is in " +
                          quote(first->second->file),
                      {transition.file, 0, 0});
  }
}

Diagnostics validate(const Robot& robot, const std::vector<Network>& networks) {
  Diagnostics diagnostics;
  check_hosts(robot, diagnostics);
  check_fallback(robot, networks, diagnostics);
  detail::check_halt(robot, networks, diagnostics);
  std::unordered_map<NetworkName, const Network*> seen;
  for (const Network& network : networks) {
    const auto [first, fresh] = seen.try_emplace(network.name, &network);
    if (!fresh) {
      diagnostics.error("duplicate-controller",
                        "two controllers are named " + quote(network.name.str()) + "; the other is in " +
                            quote(first->second->file),
                        {network.file, 0, 0});
    }
    check_network_hosts(robot, network, diagnostics);
    check_fallback_users(robot, network, diagnostics);
    detail::check_pools(robot.pools, network, diagnostics);
  }
  check_network_hosts(robot, pool_network(robot.pools), diagnostics);
  diagnostics.sort();
  return diagnostics;
}

}  // namespace segue::model
