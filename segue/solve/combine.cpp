// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/network_sets.hpp>
#include <segue/model/validate.hpp>
#include <segue/solve/combine.hpp>
#include <segue/solve/component_facts.hpp>
#include <segue/solve/placement_index.hpp>

#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

namespace segue::solve {

namespace {

using detail::PlacementIndex;
using detail::TaskLocation;

/// Finds the conflicts between two networks. Both must outlive it.
class ConflictSearch {
 public:
  ConflictSearch(const model::Network& a, const model::Network& b, const model::ComponentCatalog& catalog)
      : a_(a), b_(b), components_(catalog), places_of_a_(a), places_of_b_(b) {}

  std::vector<Conflict> search() {
    compare_tasks();
    compare_devices();
    compare_processes();
    compare_policies();
    compare_inputs();
    if (found_.empty()) check_union();
    return std::move(found_);
  }

 private:
  /// The writers of an input: the ports that write to it, and whether a sample overwrites one that waits.
  struct Writers {
    std::set<std::string> ports;
    bool overwrite = false;
  };
  using Inputs = std::map<model::PortRef, Writers>;

  void add(std::string what, std::string reason) { found_.push_back({std::move(what), std::move(reason)}); }

  [[nodiscard]] std::string name(const model::Network& network) const { return quote(network.name.str()); }
  [[nodiscard]] std::string in_both() const { return " in " + name(a_) + " and " + name(b_); }

  void compare_tasks() {
    for (const model::Task& task : b_.tasks) {
      const TaskLocation place = places_of_b_.place_of(task.id);
      const model::Task* other = places_of_a_.task(task.id);
      if (other != nullptr) {
        compare(*other, task, places_of_a_.place_of(task.id) == place);
      } else if (const model::Task* occupant = places_of_a_.occupant(place)) {
        add("place " + place.name + " in process " + to_string(place.process),
            "task " + quote(occupant->id.str()) + " of " + name(a_) + " and task " + quote(task.id.str()) +
                " of " + name(b_) + " take the same place, " + quote(place.name) + " in process " +
                to_string(place.process));
      }
    }
  }

  void compare(const model::Task& mine, const model::Task& other, bool same_place) {
    std::string_view difference;
    if (mine.component != other.component) {
      difference = "is of another component";
    } else if (!same_place) {
      difference = "runs in another process";
    } else if (!mine.same_configuration(other)) {
      difference = "is configured differently";
    } else if (mine.state != other.state) {
      difference = "is in another state";
    } else if (!(mine == other)) {
      difference = "is defined differently";
    }
    if (!difference.empty())
      add("task " + mine.id.str(),
          "task " + quote(mine.id.str()) + " " + std::string(difference) + in_both());
  }

  /// The task that holds each device.
  std::map<std::string, const model::Task*> devices_of(const model::Network& network,
                                                       const PlacementIndex& places) {
    std::map<std::string, const model::Task*> devices;
    for (const model::Task& task : network.tasks) {
      if (!is_configured(task.state)) continue;
      const auto process = places.place_of(task.id).process;
      for (std::string& device : detail::exclusive_devices(task, components_.of(task.component), process))
        devices.emplace(std::move(device), &task);
    }
    return devices;
  }

  void compare_devices() {
    const auto held = devices_of(a_, places_of_a_);
    for (const auto& [device, task] : devices_of(b_, places_of_b_)) {
      const auto found = held.find(device);
      if (found == held.end() || found->second->id == task->id) continue;
      add("device " + device, "device " + device + " is held by task " + quote(found->second->id.str()) +
                                  " of " + name(a_) + " and by task " + quote(task->id.str()) + " of " +
                                  name(b_));
    }
  }

  void compare_processes() {
    std::map<model::DeploymentKey, const model::Deployment*> mine;
    for (const model::Deployment& process : a_.deployments)
      mine.emplace(process.key(), &process);
    for (const model::Deployment& process : b_.deployments) {
      const auto found = mine.find(process.key());
      if (found == mine.end() || found->second->same_process(process)) continue;
      add("process " + to_string(process.key()),
          "process " + to_string(process.key()) + " is started differently" + in_both());
    }
  }

  /// Two ports are connected once.
  void compare_policies() {
    std::map<std::pair<model::PortRef, model::PortRef>, Policy> mine;
    for (const model::Connection& connection : a_.connections)
      mine.emplace(std::pair(connection.from, connection.to), connection.policy);
    for (const model::Connection& connection : b_.connections) {
      const auto found = mine.find({connection.from, connection.to});
      if (found == mine.end() || found->second == connection.policy) continue;
      const std::string ports = to_string(connection.from) + " -> " + to_string(connection.to);
      add("connection " + ports, "connection " + ports + " has different policies" + in_both());
    }
  }

  static Inputs inputs_of(const model::Network& network) {
    Inputs inputs;
    for (const model::Connection& connection : network.connections) {
      Writers& writers = inputs[connection.to];
      writers.ports.insert(to_string(connection.from));
      writers.overwrite = writers.overwrite || connection.policy.kind == BufferKind::Data;
    }
    return inputs;
  }

  static std::string listed_in(const std::set<std::string>& ports) {
    return listed(std::vector<std::string>(ports.begin(), ports.end()));
  }

  void compare_inputs() {
    const Inputs mine = inputs_of(a_);
    for (const auto& [input, others] : inputs_of(b_)) {
      const auto found = mine.find(input);
      if (found == mine.end() || found->second.ports == others.ports) continue;
      if (!found->second.overwrite && !others.overwrite) continue;
      add("input " + to_string(input), "input " + quote(to_string(input)) + " would be written by " +
                                           listed_in(found->second.ports) + " of " + name(a_) + " and by " +
                                           listed_in(others.ports) + " of " + name(b_) +
                                           ", which overwrite each other");
    }
  }

  /// Finds the problems of the union of networks that are both valid, such as tasks of a thread with
  /// different priorities.
  void check_union() {
    const Diagnostics problems = model::validate(model::unite(a_, b_), {}, model::Depth::Structure);
    for (const Diagnostic& problem : problems.items()) {
      if (problem.severity == Severity::Error) add(problem.message, problem.message + in_both());
    }
  }

  const model::Network& a_;
  const model::Network& b_;
  detail::KnownComponents components_;
  const PlacementIndex places_of_a_;
  const PlacementIndex places_of_b_;
  std::vector<Conflict> found_;
};

std::string joined(const std::string& text, const std::string& more) {
  return text.empty() ? more : text + "+" + more;
}

std::optional<Error> error_of(const std::vector<model::Network>& networks,
                              const model::ComponentCatalog& catalog) {
  std::string reasons;
  for (std::size_t i = 0; i < networks.size(); ++i) {
    for (std::size_t j = i + 1; j < networks.size(); ++j) {
      for (const Conflict& conflict : conflicts(networks[i], networks[j], catalog))
        reasons += (reasons.empty() ? "" : "; ") + conflict.reason;
    }
  }
  if (reasons.empty()) return std::nullopt;
  return fail(ErrorCode::InvalidState, "these controllers cannot run at once: " + reasons);
}

}  // namespace

std::vector<Conflict> conflicts(const model::Network& a, const model::Network& b,
                                const model::ComponentCatalog& catalog) {
  return ConflictSearch(a, b, catalog).search();
}

std::vector<Conflict> influences(const model::Network& by, const model::Network& on) {
  const PlacementIndex tasks(on);
  std::set<std::string> own;
  for (const model::Connection& connection : on.connections)
    own.insert(to_string(connection));
  std::vector<Conflict> found;
  for (const model::Connection& connection : by.connections) {
    if (!tasks.has_task(connection.to.task) || own.contains(to_string(connection))) continue;
    found.push_back({"input " + to_string(connection.to),
                     to_string(connection.from) + " of " + quote(by.name.str()) + " writes to input " +
                         quote(to_string(connection.to)) + " of " + quote(on.name.str())});
  }
  return found;
}

Result<model::Network> combine(const std::vector<model::Network>& networks,
                               const model::ComponentCatalog& catalog) {
  if (auto error = error_of(networks, catalog)) return std::move(*error);
  model::Network all;
  std::string name;
  std::string version;
  bool versions = true;
  for (const model::Network& network : networks) {
    all = model::unite(std::move(all), network);
    name = joined(name, network.name.str());
    version = joined(version, network.version);
    versions = versions && !network.version.empty();
  }
  all.name = model::NetworkName(name);
  all.version = versions ? version : std::string();
  return all;
}

}  // namespace segue::solve
