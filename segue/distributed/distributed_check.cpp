// SPDX-License-Identifier: Apache-2.0
#include <segue/distributed/distributed_check.hpp>

#include <segue/base/text.hpp>
#include <segue/fleet/action_dispatcher.hpp>

#include <algorithm>
#include <map>
#include <set>
#include <string_view>

namespace segue::distributed::detail {

namespace {

class Checker {
 public:
  Checker(const model::Network& network, const Sites& sites, const model::ComponentCatalog& catalog,
          const DistributedOptions& options)
      : network_(network),
        sites_(sites),
        catalog_(catalog),
        options_(options),
        processes_(model::task_processes(network)) {}

  Diagnostics check() {
    for (const auto& deployment : network_.deployments) {
      check_deployment(deployment);
    }
    for (const auto& task : network_.tasks) {
      const auto process = processes_.find(task.id);
      check_task(task, process == processes_.end() ? model::kLocalHost : process->second.host);
    }
    check_libraries();
    for (const auto& connection : network_.connections) {
      check_link(connection);
    }
    return std::move(findings_);
  }

 private:
  void check_deployment(const model::Deployment& deployment) {
    const auto site = sites_.find(deployment.host);
    if (!site) {
      findings_.error("unknown-host",
                      "process " + quote(to_string(deployment.key())) + ": " + site.error().message,
                      deployment.where);
      return;
    }
    if (deployment.process == kGatewayProcess) {
      findings_.error("reserved-name",
                      "process " + quote(to_string(deployment.key())) +
                          ": this is the name of the process that connects hosts; choose another one",
                      deployment.where);
    }
  }

  void check_task(const model::Task& task, const model::HostName& host) {
    const auto site = sites_.find(host);
    if (!site) {
      return;
    }
    site_of_.emplace(task.id, *site);
    const auto* component = catalog_.find(task.component);
    const bool simulated = options_.stand_in || options_.only_stand_ins;
    if ((*site)->link() == nullptr || !(*site)->reachable() || component == nullptr) {
      return;
    }
    if (!offers(**site, task.component)) {
      if (!simulated) {
        findings_.error("not-installed",
                        "task " + quote(task.id.str()) + ": host " + quote(host.str()) +
                            " has no library that offers component " + quote(task.component.str()) +
                            library_hint(*component) + "; install it there",
                        task.where);
      }
      return;
    }
    if (!options_.only_stand_ins && !component->library.empty()) {
      used_[component->library].insert(*site);
    }
  }

  static std::string library_hint(const model::ComponentModel& component) {
    return component.library.empty() ? std::string() : " (" + quote(component.library) + ")";
  }

  /// Hosts of one architecture must have the same file of a library.
  void check_libraries() {
    struct First {
      const Site* site;
      std::string digest;
    };
    for (const auto& [library, used_on] : used_) {
      std::map<std::string, First> first;  // by architecture
      for (const Site* site : used_on) {
        const HostInfo info = site->link()->info();
        const auto found = std::find_if(
            info.libraries.begin(), info.libraries.end(),
            [&, library = std::string_view(library)](const LibraryInfo& one) { return one.name == library; });
        if (found == info.libraries.end()) {
          continue;
        }
        const auto [other, fresh] = first.try_emplace(info.architecture, First{site, found->digest});
        if (!fresh && other->second.digest != found->digest) {
          findings_.error("library-differs",
                          "component library " + quote(library) + " differs: host " +
                              quote(other->second.site->name().str()) + " has " +
                              other->second.digest.substr(0, 12) + ", host " + quote(site->name().str()) +
                              " has " + found->digest.substr(0, 12) + "; install the same on both",
                          {network_.file, 0, 0});
        }
      }
    }
  }

  void check_link(const model::Connection& connection) {
    const auto from = site_of_.find(connection.from.task);
    const auto to = site_of_.find(connection.to.task);
    if (from == site_of_.end() || to == site_of_.end()) {
      return;
    }
    const Transport transport = connection.policy.transport;
    if (from->second == to->second) {
      check_link_within(connection, *from->second);
    } else if (transport == Transport::Local || transport == Transport::SharedMemory) {
      findings_.error("link",
                      to_string(connection) + ": 'link: " + std::string(to_string(transport)) +
                          "' needs both tasks on one host, but they live on " +
                          quote(from->second->name().str()) + " and " + quote(to->second->name().str()) +
                          "; leave the link out, or move one of them",
                      connection.where);
    }
  }

  /// The runtime's own computer checks its links itself.
  void check_link_within(const model::Connection& connection, const Site& site) {
    if (site.link() == nullptr) {
      return;
    }
    const auto& from = processes_.at(connection.from.task);
    const auto& to = processes_.at(connection.to.task);
    if (from == to) {
      return;
    }
    if (auto possible = fleet::detail::check_link(connection, from, to); !possible) {
      findings_.error("link", to_string(connection) + ": " + possible.error().message, connection.where);
    }
  }

  const model::Network& network_;
  const Sites& sites_;
  const model::ComponentCatalog& catalog_;
  const DistributedOptions& options_;
  const std::map<model::TaskId, model::DeploymentKey> processes_;
  Diagnostics findings_;
  std::map<model::TaskId, const Site*> site_of_;
  std::map<std::string, std::set<const Site*>> used_;  ///< libraries, and the hosts that use them
};

}  // namespace

Diagnostics check_hosts(const model::Network& network, const Sites& sites,
                        const model::ComponentCatalog& catalog, const DistributedOptions& options) {
  return Checker(network, sites, catalog, options).check();
}

bool offers(const Site& site, const model::ComponentName& component) {
  if (site.link() == nullptr) {
    return false;
  }
  const HostInfo info = site.link()->info();
  return std::any_of(info.libraries.begin(), info.libraries.end(), [&](const LibraryInfo& library) {
    return std::find(library.components.begin(), library.components.end(), component) !=
           library.components.end();
  });
}

}  // namespace segue::distributed::detail
