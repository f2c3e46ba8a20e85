// SPDX-License-Identifier: Apache-2.0
#include <segue/fleet/deployed_task_host.hpp>

#include <segue/base/text.hpp>
#include <segue/fleet/action_dispatcher.hpp>
#include <segue/fleet/commit_coordinator.hpp>
#include <segue/fleet/fleet.hpp>
#include <segue/fleet/remote_connector.hpp>

#include <algorithm>

namespace segue::fleet {

namespace {

/// How long the removal of orphaned endpoints may take.
constexpr Duration kCleaning = std::chrono::seconds(2);
/// How long processes may take to map each other's memory ahead. The others do so when they are connected.
constexpr Duration kGettingReady = std::chrono::seconds(1);

TimePoint in(Duration duration) {
  return RealClock::instance().now() + duration;
}

void check_hosts(const model::Network& network, const std::vector<model::HostName>& hosts,
                 Diagnostics& findings) {
  for (const auto& deployment : network.deployments) {
    if (std::find(hosts.begin(), hosts.end(), deployment.host) == hosts.end()) {
      findings.error("other-host",
                     "process " + quote(to_string(deployment.key())) +
                         ": its host is another computer; processes can only be started on the runtime's own",
                     deployment.where);
    }
  }
}

void check_links(const model::Network& network, Diagnostics& findings) {
  const auto processes = model::task_processes(network);
  const auto process_of = [&](const model::TaskId& task) {
    const auto process = processes.find(task);
    return process == processes.end() ? model::DeploymentKey{} : process->second;
  };
  for (const auto& connection : network.connections) {
    const auto from = process_of(connection.from.task);
    const auto to = process_of(connection.to.task);
    const auto possible = from == to ? Result<void>() : detail::check_link(connection, from, to);
    if (!possible) {
      findings.error("link", to_string(connection) + ": " + possible.error().message, connection.where);
    }
  }
}

}  // namespace

struct DeployedTaskHost::Implementation {
  Implementation(deploy::DeploymentService& own, process_server::ProcessService& processes,
                 Connector connector, process_server::Launch launch, const task_host::TaskHost& local_host,
                 const DeployedOptions& options)
      : local(local_host),
        hosts(options.hosts),
        fleet(std::make_shared<detail::Fleet>(own, processes, std::move(connector), std::move(launch),
                                              options)) {}

  const task_host::TaskHost& local;
  const std::vector<model::HostName> hosts;
  const std::shared_ptr<detail::Fleet> fleet;
  detail::RemoteConnector remote_connector{*fleet};
  detail::CommitCoordinator commits{*fleet, remote_connector};
  detail::ActionDispatcher dispatcher{*fleet, remote_connector, commits};
};

DeployedTaskHost::DeployedTaskHost(deploy::DeploymentService& own, process_server::ProcessService& processes,
                                   Connector connector, process_server::Launch launch,
                                   const task_host::TaskHost& local, const DeployedOptions& options)
    : implementation_(std::make_unique<Implementation>(own, processes, std::move(connector),
                                                       std::move(launch), local, options)) {
  auto& remote_connector = implementation_->remote_connector;
  implementation_->fleet->set_housekeeping(
      [&remote_connector] { remote_connector.remove_orphaned(in(kCleaning)); });
  implementation_->fleet->begin();
  remote_connector.remove_orphaned(in(kCleaning));
}

DeployedTaskHost::~DeployedTaskHost() {
  implementation_->fleet->close();
}

bool DeployedTaskHost::stands_in(const model::ComponentName& component) const {
  return implementation_->local.stands_in(component);
}

Result<void> DeployedTaskHost::can_make(const model::ComponentName& component) const {
  return implementation_->local.can_make(component);
}

Diagnostics DeployedTaskHost::check(const model::Network& network) const {
  Diagnostics findings;
  check_hosts(network, implementation_->hosts, findings);
  check_links(network, findings);
  findings.append(implementation_->local.check(network));
  return findings;
}

void DeployedTaskHost::end_processes(TimePoint deadline) {
  implementation_->fleet->end_all(deadline);
}

void DeployedTaskHost::expect(const model::Network& target) {
  implementation_->fleet->expect(target);
}

void DeployedTaskHost::begin_transition(const model::Network& before, const model::Network& target) {
  implementation_->commits.settle();
  expect(target);
  implementation_->fleet->placements().begin_transition(before, target);
}

void DeployedTaskHost::get_ready(const model::Network& target) {
  const auto processes = model::task_processes(target);
  const auto record_of = [&](const model::TaskId& task) {
    const auto process = processes.find(task);
    return implementation_->fleet->find(process == processes.end() ? model::DeploymentKey{}
                                                                   : process->second);
  };
  std::vector<detail::ProcessPair> pairs;
  for (const auto& connection : target.connections) {
    auto writer = record_of(connection.from.task);
    auto reader = record_of(connection.to.task);
    if (writer != nullptr && reader != nullptr && writer != reader) {
      pairs.emplace_back(std::move(writer), std::move(reader));
    }
  }
  implementation_->remote_connector.map_peers(pairs, in(kGettingReady));
}

Result<void> DeployedTaskHost::arm_commit(const model::Transition& transition, TimePoint deadline) {
  return implementation_->commits.arm(transition, deadline);
}

Result<void> DeployedTaskHost::commit() {
  implementation_->commits.commit();
  return {};
}

void DeployedTaskHost::conclude(const model::Transition& transition) {
  implementation_->dispatcher.conclude(transition);
}

void DeployedTaskHost::withdraw() {
  implementation_->dispatcher.withdraw();
}

void DeployedTaskHost::begin_all(std::vector<model::Action> actions, TimePoint deadline,
                                 task_host::Completion completed) {
  implementation_->dispatcher.begin(std::move(actions), deadline, std::move(completed));
}

model::Network DeployedTaskHost::observe() const {
  return implementation_->fleet->poll_merged().network;
}

std::vector<task_host::TaskReport> DeployedTaskHost::tasks() const {
  return implementation_->fleet->poll_merged().tasks;
}

std::vector<task_host::ConnectionReport> DeployedTaskHost::connections() const {
  return snapshot().connections;
}

DeployedTaskHost::View DeployedTaskHost::snapshot() const {
  auto merged = implementation_->fleet->poll_merged();
  for (auto& damaged : implementation_->remote_connector.note_damage(merged)) {
    merged.connections.push_back(std::move(damaged));
  }
  return {std::move(merged.network), std::move(merged.tasks), std::move(merged.connections)};
}

Result<task_host::TaskPlace> DeployedTaskHost::find_place(const model::TaskId& task,
                                                          task_host::Purpose purpose) const {
  const bool restores = purpose == task_host::Purpose::Restore;
  auto located =
      implementation_->fleet->locate(task, restores ? detail::Which::Next : detail::Which::Current);
  if (!located) {
    return std::move(located.error());
  }
  const detail::ProcessRecord& record = *located->record;
  if (!record.answers()) {
    return fail(ErrorCode::Unavailable, detail::silence_text(record.key(), record.process().pid));
  }
  auto service = record.service();
  if (service == nullptr) {
    return record.unreachable();
  }
  return task_host::TaskPlace{std::move(service), std::move(located->task)};
}

void DeployedTaskHost::set_listener(Listener listener) {
  implementation_->fleet->events().set_listener(std::move(listener));
}

}  // namespace segue::fleet
