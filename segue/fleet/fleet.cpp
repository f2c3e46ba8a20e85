// SPDX-License-Identifier: Apache-2.0
#include <segue/fleet/fleet.hpp>

#include <segue/base/text.hpp>
#include <segue/task_host/full_id.hpp>

#include <algorithm>

namespace segue::fleet::detail {

namespace {

/// The record of the runtime's own process, whose service outlives the fleet and so is not owned.
RecordPtr own_record(deploy::DeploymentService& own) {
  auto info = own.info();
  model::Deployment deployment;
  process_server::ProcessInfo process;
  if (info) {
    process.pid = info->pid;
  }
  auto record = std::make_shared<ProcessRecord>(std::move(deployment), std::move(process));
  record->set_service({std::shared_ptr<void>(), &own}, info ? std::optional(*std::move(info)) : std::nullopt);
  return record;
}

}  // namespace

Fleet::Fleet(deploy::DeploymentService& own, process_server::ProcessService& processes, Connector connector,
             process_server::Launch launch, const DeployedOptions& options)
    : processes_(processes),
      connector_(std::move(connector)),
      launch_(std::move(launch)),
      options_(options),
      own_(own_record(own)) {}

std::optional<process_server::ProcessInfo> Fleet::Starting::exit_of(int pid) const {
  const auto found =
      std::find_if(exits.begin(), exits.end(), [&](const auto& process) { return process.pid == pid; });
  return found == exits.end() ? std::nullopt : std::optional(*found);
}

void Fleet::begin() {
  processes_.set_listener([weak = weak_from_this()](const process_server::ProcessInfo& process) {
    if (const auto self = weak.lock()) {
      self->on_exit(process);
    }
  });
  listen_to(own_, *own_->service());
  adopt();
  watcher_ = concurrent::start_thread("segue-fleet", [this] { watch(); });
}

void Fleet::close() {
  {
    const Lock lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
  processes_.set_listener({});
  if (watcher_.joinable()) {
    watcher_.join();
  }
  pool_.close();
  for (const auto& record : all()) {
    if (const auto service = record->service()) {
      service->set_listener({});
    }
    record->set_service(nullptr, std::nullopt);
  }
  events_.set_listener({});
}

RecordPtr Fleet::find(const model::DeploymentKey& key) const {
  if (key.is_runtime()) {
    return own_;
  }
  const Lock lock(mutex_);
  const auto found = records_.find(key);
  return found == records_.end() ? nullptr : found->second;
}

RecordPtr Fleet::find(sample_link::Incarnation incarnation) const {
  for (auto& record : all()) {
    if (record->incarnation() == incarnation) {
      return record;
    }
  }
  return nullptr;
}

std::vector<RecordPtr> Fleet::all() const {
  std::vector<RecordPtr> records{own_};
  const Lock lock(mutex_);
  for (const auto& [key, record] : records_) {
    records.push_back(record);
  }
  return records;
}

Result<Fleet::Located> Fleet::locate(const model::TaskId& id, Which which) const {
  const auto place = placements_.find(id, which);
  if (!place) {
    return place.error();
  }
  auto record = find(place->process);
  if (record == nullptr) {
    return fail(ErrorCode::NotFound, "its process " + quote(to_string(place->process)) + " is gone",
                id.str());
  }
  return Located{std::move(record), place->task};
}

void Fleet::update_placements(const ProcessRecord& record, std::uint64_t poll,
                              const deploy::Snapshot& snapshot) {
  std::set<model::TaskId> tasks;
  for (const auto& task : snapshot.network.tasks) {
    tasks.insert(task.id);
  }
  placements_.update(record.key(), tasks, poll);
}

namespace {

/// The part of a network that a process needs: its tasks and their connections, by plain ids.
model::Network part_of(const model::Network& network, const model::DeploymentKey& key) {
  const auto processes = model::task_processes(network);
  const auto is_here = [&](const model::TaskId& task) {
    const auto process = processes.find(task);
    return process == processes.end() ? key.is_runtime() : process->second == key;
  };
  model::Network part;
  part.name = network.name;
  std::copy_if(network.tasks.begin(), network.tasks.end(), std::back_inserter(part.tasks),
               [&](const model::Task& task) { return is_here(task.id); });
  std::copy_if(network.connections.begin(), network.connections.end(), std::back_inserter(part.connections),
               [&](const model::Connection& connection) {
                 return is_here(connection.from.task) || is_here(connection.to.task);
               });
  for (auto& task : part.tasks) {
    task.id = task_host::plain_id(task.id);
  }
  for (auto& connection : part.connections) {
    connection.from.task = task_host::plain_id(connection.from.task);
    connection.to.task = task_host::plain_id(connection.to.task);
  }
  return part;
}

void send_expectation(deploy::DeploymentService& service, const model::Network& network,
                      const model::DeploymentKey& key) {
  const model::Network part = part_of(network, key);
  if (!part.empty()) {
    // A process that does not answer is found by the next poll; its successor is sent this again.
    (void)service.expect(part);
  }
}

}  // namespace

void Fleet::expect(const model::Network& network) {
  if (!launch_.stand_in && !launch_.only_stand_ins) {
    return;  // only stand-ins take their ports from the network
  }
  {
    const Lock lock(mutex_);
    const auto known = std::find_if(expected_.begin(), expected_.end(),
                                    [&](const auto& other) { return other.name == network.name; });
    if (known != expected_.end() && *known == network) {
      return;
    }
    if (known == expected_.end()) {
      expected_.push_back(network);
    } else {
      *known = network;
    }
  }
  std::vector<concurrent::ThreadPool::Job> jobs;
  for (const auto& record : all()) {
    jobs.emplace_back([&network, record] {
      if (const auto service = record->service()) {
        send_expectation(*service, network, record->key());
      }
    });
  }
  pool_.run_all(std::move(jobs));
}

void Fleet::send_expectations(deploy::DeploymentService& service, const model::DeploymentKey& key) {
  std::vector<model::Network> expected;
  {
    const Lock lock(mutex_);
    expected = expected_;
  }
  for (const auto& network : expected) {
    send_expectation(service, network, key);
  }
}

}  // namespace segue::fleet::detail
