// SPDX-License-Identifier: Apache-2.0
#include <segue/fleet/merged_view.hpp>

#include <segue/base/text.hpp>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

namespace segue::fleet::detail {

namespace {

/// The identity of a connection, as both of its endpoints state it.
struct EndpointKey {
  sample_link::Incarnation writer = 0;
  sample_link::Incarnation reader = 0;
  std::uint64_t offset = 0;
  std::uint64_t generation = 0;
  model::PortRef from;
  model::PortRef to;
  Policy policy;

  friend auto operator<=>(const EndpointKey&, const EndpointKey&) = default;
};

EndpointKey key_of(const deploy::EndpointReport& endpoint, sample_link::Incarnation own) {
  const bool output = endpoint.side == deploy::Side::Output;
  return {output ? own : endpoint.peer, output ? endpoint.peer : own, endpoint.place.offset,
          endpoint.place.generation,    endpoint.connection.from,     endpoint.connection.to,
          endpoint.connection.policy};
}

class Merger {
 public:
  Merger(const std::vector<ProcessView>& processes, const FindName& name_of)
      : processes_(processes), name_of_(name_of) {}

  MergedView merge() {
    for (const ProcessView& process : processes_) {
      add_process(process);
    }
    add_endpoints();
    sort();
    return std::move(merged_);
  }

 private:
  void add_process(const ProcessView& process) {
    const bool own = process.deployment.key().is_runtime();
    model::Deployment deployment = process.deployment;
    deployment.tasks.clear();
    if (process.is_to_be_replaced()) {
      deployment.deployer = "unknown";
    }
    if (process.snapshot != nullptr) {
      add_tasks(process, deployment);
    }
    if (!own) {
      merged_.network.deployments.push_back(std::move(deployment));
    }
  }

  void add_tasks(const ProcessView& process, model::Deployment& deployment) {
    const deploy::Snapshot& snapshot = *process.snapshot;
    const auto names = names_in(snapshot.network);
    for (const model::Task& task : snapshot.network.tasks) {
      const auto name = names.find(task.id);
      const model::TaskId id = called(task.id, process);
      deployment.tasks.push_back({id, name == names.end() ? task.id.str() : name->second});
      merged_.network.tasks.push_back(task);
      merged_.network.tasks.back().id = id;
      if (process.is_to_be_replaced()) {
        merged_.network.tasks.back().state = TaskState::Fatal;
      }
    }
    for (const task_host::TaskReport& report : snapshot.tasks) {
      add_report(process, report);
    }
    if (!process.is_silent()) {
      for (const auto& connection : snapshot.network.connections) {
        merged_.network.connections.push_back(called(connection, process, process));
      }
      for (task_host::ConnectionReport report : snapshot.connections) {
        report.connection = called(report.connection, process, process);
        merged_.connections.push_back(std::move(report));
      }
    }
  }

  void add_report(const ProcessView& process, task_host::TaskReport report) {
    if (!process.deployment.key().is_runtime()) {
      report.process = process.deployment.key();
      report.pid = process.pid;
    }
    if (std::string why = trouble(process, report.id); !why.empty()) {
      report.state = TaskState::Fatal;
      report.state_name = to_string(TaskState::Fatal);
      report.error = std::move(why);
    }
    report.id = called(report.id, process);
    merged_.tasks.push_back(std::move(report));
  }

  /// Why a task is Fatal whatever state it reports; "" where it is not.
  static std::string trouble(const ProcessView& process, const model::TaskId& task) {
    if (process.is_silent()) {
      return silence_text(process.deployment.key(), process.pid);
    }
    if (!process.fault.empty()) {
      return process.fault;
    }
    const auto& hanging = process.snapshot->hanging;
    const bool hangs = std::find(hanging.begin(), hanging.end(), task) != hanging.end();
    return hangs ? hanging_text(process, task) : std::string();
  }

  [[nodiscard]] model::TaskId called(const model::TaskId& task, const ProcessView& process) const {
    return name_of_(task, process.deployment.key());
  }
  [[nodiscard]] model::Connection called(model::Connection connection, const ProcessView& writer,
                                         const ProcessView& reader) const {
    connection.from.task = called(connection.from.task, writer);
    connection.to.task = called(connection.to.task, reader);
    return connection;
  }

  static std::map<model::TaskId, std::string> names_in(const model::Network& network) {
    std::map<model::TaskId, std::string> names;
    for (const auto& deployment : network.deployments) {
      for (const auto& placement : deployment.tasks) {
        names.emplace(placement.task, placement.name);
      }
    }
    return names;
  }

  /// The order does not depend on how tasks are distributed over processes.
  void sort() {
    const auto by_id = [](const auto& a, const auto& b) { return a.id < b.id; };
    std::sort(merged_.network.tasks.begin(), merged_.network.tasks.end(), by_id);
    std::sort(merged_.tasks.begin(), merged_.tasks.end(), by_id);
    const auto identity = [](const model::Connection& one) { return std::tie(one.from, one.to, one.policy); };
    std::sort(merged_.network.connections.begin(), merged_.network.connections.end(),
              [&](const auto& a, const auto& b) { return identity(a) < identity(b); });
    std::sort(merged_.connections.begin(), merged_.connections.end(),
              [&](const auto& a, const auto& b) { return identity(a.connection) < identity(b.connection); });
  }

  void add_endpoints() {
    struct Input {
      const ProcessView* process;
      const deploy::EndpointReport* report;
    };
    std::map<EndpointKey, Input> inputs;
    for_each_endpoint([&](const ProcessView& process, const deploy::EndpointReport& endpoint) {
      if (endpoint.side == deploy::Side::Input) {
        inputs.emplace(key_of(endpoint, process.incarnation), Input{&process, &endpoint});
      }
    });
    std::set<EndpointKey> whole;
    std::set<EndpointKey> paired;  // both endpoints are there, but carry nothing
    for_each_endpoint([&](const ProcessView& process, const deploy::EndpointReport& output) {
      const EndpointKey key = key_of(output, process.incarnation);
      const auto input = output.side == deploy::Side::Output ? inputs.find(key) : inputs.end();
      if (input == inputs.end()) {
        return;
      }
      if (!output.carries || !input->second.report->carries) {
        paired.insert(key);
        return;
      }
      const model::Connection connection = called(output.connection, process, *input->second.process);
      const deploy::EndpointReport& read = *input->second.report;
      if (output.damage != sample_link::Damage::None || read.damage != sample_link::Damage::None) {
        merged_.damaged.push_back({connection, output.corrupt + read.corrupt,
                                   suspects_of(process, output, *input->second.process, read)});
      } else if (whole.insert(key).second) {
        add_connection(output, connection, input->second.report->latency);
      }
    });
    for_each_endpoint([&](const ProcessView& process, const deploy::EndpointReport& endpoint) {
      const EndpointKey key = key_of(endpoint, process.incarnation);
      // Outputs are closed first.
      const bool stays = endpoint.side == deploy::Side::Input && paired.contains(key);
      if (!stays && !whole.contains(key)) {
        add_orphaned(process, endpoint);
      }
    });
  }

  [[nodiscard]] std::vector<Suspect> suspects_of(const ProcessView& writer,
                                                 const deploy::EndpointReport& output,
                                                 const ProcessView& reader,
                                                 const deploy::EndpointReport& input) const {
    std::vector<Suspect> suspects{{writer.deployment.key(), writer.incarnation}};
    if (output.damage == sample_link::Damage::None && input.damage == sample_link::Damage::Payload) {
      return suspects;
    }
    suspects.push_back({reader.deployment.key(), reader.incarnation});
    for_each_endpoint([&](const ProcessView& process, const deploy::EndpointReport& endpoint) {
      const Suspect peer{process.deployment.key(), process.incarnation};
      const bool known = std::find(suspects.begin(), suspects.end(), peer) != suspects.end();
      if (endpoint.peer == reader.incarnation && !known) {
        suspects.push_back(peer);
      }
    });
    return suspects;
  }

  template <class See>
  void for_each_endpoint(See see) const {
    for (const ProcessView& process : processes_) {
      if (process.is_silent() || process.snapshot == nullptr) {
        continue;
      }
      for (const deploy::EndpointReport& endpoint : process.snapshot->endpoints) {
        see(process, endpoint);
      }
    }
  }

  void add_connection(const deploy::EndpointReport& output, const model::Connection& connection,
                      const sample_link::Latency& latency) {
    merged_.network.connections.push_back(connection);
    merged_.connections.push_back(
        {connection, output.counters.written, output.counters.read, output.counters.dropped, latency});
  }

  void add_orphaned(const ProcessView& process, const deploy::EndpointReport& endpoint) {
    const auto peer = std::find_if(processes_.begin(), processes_.end(), [&](const ProcessView& other) {
      return other.incarnation == endpoint.peer;
    });
    const bool found = peer != processes_.end();
    if (found && peer->is_silent()) {
      return;  // its endpoint may be connected
    }
    // A process whose incarnation is not known yet may be the peer.
    const bool all_known = std::all_of(processes_.begin(), processes_.end(),
                                       [](const ProcessView& other) { return other.incarnation != 0; });
    if (found || all_known) {
      merged_.orphaned.push_back(
          {process.deployment.key(), endpoint.connection, endpoint.side, endpoint.peer, !found});
    }
  }

  const std::vector<ProcessView>& processes_;
  const FindName& name_of_;
  MergedView merged_;
};

}  // namespace

MergedView merge(const std::vector<ProcessView>& processes, const FindName& name_of) {
  return Merger(processes, name_of).merge();
}

std::string suspect_text(const std::vector<Suspect>& suspects) {
  std::vector<std::string> names;
  for (const Suspect& one : suspects) {
    names.push_back(one.process.is_runtime() ? "the runtime's own" : quote(to_string(one.process)));
  }
  return names.size() == 1 ? "process " + names.front() : "one of the processes " + listed(names);
}

std::string damage_text(const DamagedConnection& damaged) {
  const std::string found =
      damaged.corrupt > 0 ? " (" + std::to_string(damaged.corrupt) + " invalid entries)" : std::string();
  return "its shared memory was overwritten by " + suspect_text(damaged.suspects) + found +
         "; a transition makes it again";
}

std::string silence_text(const model::DeploymentKey& process, int pid) {
  if (process.is_runtime()) {
    return "the runtime's own process is too busy to answer";
  }
  return "process " + quote(to_string(process)) + " (pid " + std::to_string(pid) +
         ") does not answer; a transition replaces it";
}

std::string hanging_text(const ProcessView& process, const model::TaskId& task) {
  const auto& reports = process.snapshot->tasks;
  const auto report = std::find_if(reports.begin(), reports.end(),
                                   [&](const task_host::TaskReport& one) { return one.id == task; });
  const std::string what = report == reports.end() ? "it does not return" : report->error;
  const model::DeploymentKey key = process.deployment.key();
  if (key.is_runtime()) {
    return what +
           "; no transition can replace it in the runtime's own process: restart the runtime, and give the "
           "task a deployment of its own";
  }
  return what + "; a transition replaces process " + quote(to_string(key));
}

}  // namespace segue::fleet::detail
