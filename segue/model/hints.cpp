// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/hints.hpp>
#include <segue/model/network_index.hpp>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace segue::model {
namespace {

/// Chains of fewer hops change the process often because a device or a crash must stay in its own.
constexpr std::size_t kFewestHops = 3;

std::string listed_quoted(std::vector<std::string> names) {
  for (std::string& name : names)
    name = quote(name);
  return listed(names);
}

class HintSearch {
 public:
  HintSearch(const Network& network, const ComponentCatalog& catalog)
      : network_(network), index_(network, catalog) {
    for (const Connection& connection : network.connections) {
      into_[connection.to].push_back(&connection);
      ends_[connection.to.task].in.push_back(&connection);
      ends_[connection.from.task].out.push_back(&connection);
    }
  }

  Diagnostics run() {
    for (const Task& task : network_.tasks)
      look_at_inputs(task);
    for (const auto& [input, connections] : into_)
      look_at_writers(input, connections);
    for (const Connection& connection : network_.connections)
      look_at_buffer(connection);
    look_at_chains();
    look_at_processors();
    found_.sort();
    return std::move(found_);
  }

 private:
  void hint(std::string code, std::string message, const SourceLocation& where) {
    found_.add({Severity::Hint, std::move(code), std::move(message), detail::place(where, network_)});
  }

  /// nullptr: its component is not known.
  [[nodiscard]] const Activity* activity_of(const Task& task) const {
    if (task.activity) return &*task.activity;
    const auto* component = index_.component(task.component);
    return component == nullptr ? nullptr : &component->model().activity;
  }

  /// A stopped task may be started, but one that is not configured may lack ports.
  void look_at_inputs(const Task& task) {
    const auto* component = index_.component(task.component);
    if (component == nullptr || component->model().incomplete || task.state == TaskState::PreOperational)
      return;
    const ComponentModel& model = component->model();
    std::set<std::string> written;
    for (const Connection* connection : ends_[task.id].in)
      written.insert(connection->to.port);
    const auto& own = model.trigger_ports;
    const auto& named = activity_of(task)->triggers;
    const auto triggers = [&](const std::string& port) {
      if (!named.empty()) return named.contains(port);
      return own.empty() || std::ranges::find(own, port) != own.end();
    };
    std::vector<std::string> unwritten;
    for (const PortModel& port : model.ports) {
      if (port.direction == Direction::Input && !port.dynamic && !written.contains(port.name))
        unwritten.push_back(port.name);
    }
    const bool never = !unwritten.empty() && activity_of(task)->trigger == Trigger::PortDriven &&
                       std::ranges::none_of(written, triggers);
    if (never) std::erase_if(unwritten, [&](const std::string& port) { return !triggers(port); });
    if (unwritten.empty()) return;
    const std::string what = "task " + quote(task.id.str()) + ": nothing writes to its input" +
                             (unwritten.size() > 1 ? "s " : " ") + listed_quoted(unwritten);
    if (never) return hint("never-updates", what + ", so it never updates", task.where);
    hint("unwritten-input", what, task.where);
  }

  void look_at_writers(const PortRef& input, const std::vector<const Connection*>& connections) {
    std::vector<std::string> writers;
    for (const Connection* connection : connections) {
      if (connection->policy.kind == BufferKind::Data) writers.push_back(to_string(connection->from));
    }
    if (writers.size() < 2) return;
    hint("several-writers",
         "input " + quote(to_string(input)) + " is written by " + listed_quoted(writers) +
             ": it keeps the newest sample of each, and its task reads them in turn",
         connections.back()->where);
  }

  /// Components usually read one sample of a port in each update.
  void look_at_buffer(const Connection& connection) {
    if (connection.policy.kind == BufferKind::Data) return;
    const Task* writer = index_.task(connection.from.task);
    const Task* reader = index_.task(connection.to.task);
    if (writer == nullptr || reader == nullptr) return;
    const Activity* writes = activity_of(*writer);
    const Activity* reads = activity_of(*reader);
    const auto is_periodic = [](const Activity* activity) {
      return activity != nullptr && activity->trigger == Trigger::Periodic;
    };
    if (!is_periodic(writes) || !is_periodic(reads) || writes->period >= reads->period) return;
    hint("buffer-runs-full",
         "connection " + to_string(connection) + ": " + quote(writer->id.str()) + " is updated every " +
             format_duration(writes->period) + ", " + quote(reader->id.str()) + " every " +
             format_duration(reads->period) +
             ": unless it reads several samples in an update, the buffer is full " +
             (connection.policy.kind == BufferKind::Buffer ? "and refuses samples"
                                                           : "and drops the oldest samples"),
         connection.where);
  }

  /// Whether its ends are in different processes of one computer.
  [[nodiscard]] bool changes_process(const Connection& connection) const {
    const TaskId& from = connection.from.task;
    const TaskId& to = connection.to.task;
    return index_.deployment(from) != index_.deployment(to) && index_.host(from) == index_.host(to);
  }

  /// The connection by which a task passes samples on, where it has one input and one output, both connected
  /// with other processes; else nullptr.
  [[nodiscard]] const Connection* passes_on(const TaskId& task) const {
    const auto found = ends_.find(task);
    if (found == ends_.end()) return nullptr;
    const auto& [in, out] = found->second;
    const bool passes =
        in.size() == 1 && out.size() == 1 && changes_process(*in[0]) && changes_process(*out[0]);
    return passes ? out[0] : nullptr;
  }

  void look_at_chains() {
    for (const Connection& first : network_.connections) {
      if (!changes_process(first) || passes_on(first.from.task) != nullptr) continue;
      std::vector<std::string> tasks{first.from.task.str(), first.to.task.str()};
      while (const Connection* next = passes_on(TaskId(tasks.back())))
        tasks.push_back(next->to.task.str());
      if (tasks.size() <= kFewestHops) continue;
      hint("process-at-each-hop",
           "samples change the process at each hop from " + quote(tasks.front()) + " by way of " +
               listed_quoted({tasks.begin() + 1, tasks.end() - 1}) + " to " + quote(tasks.back()) +
               ": within one process, a hop takes a fraction of the time",
           first.where);
    }
  }

  void look_at_processors() {
    std::map<HostName, std::vector<const Deployment*>> by_host;
    for (const Deployment& deployment : network_.deployments)
      by_host[deployment.host].push_back(&deployment);
    for (const auto& [host, deployments] : by_host) {
      const Deployment& first = *deployments.front();
      const auto shares = [&](const Deployment* other) { return other->cpus == first.cpus; };
      if (deployments.size() < 2 || first.cpus.size() != 1 || !std::ranges::all_of(deployments, shares))
        continue;
      hint("one-processor",
           "all " + std::to_string(deployments.size()) + " processes on " + host.str() +
               " run on processor " + std::to_string(first.cpus[0]) + ", so only one of them runs at a time",
           first.where);
    }
  }

  const Network& network_;
  const detail::NetworkIndex index_;
  struct Ends {
    std::vector<const Connection*> in;
    std::vector<const Connection*> out;
  };
  std::unordered_map<TaskId, Ends> ends_;  ///< by task
  std::map<PortRef, std::vector<const Connection*>> into_;
  Diagnostics found_;
};

}  // namespace

Diagnostics hints(const Network& network, const ComponentCatalog& catalog) {
  return HintSearch(network, catalog).run();
}

}  // namespace segue::model
