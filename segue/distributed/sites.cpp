// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>
#include <segue/distributed/sites.hpp>

#include <segue/base/text.hpp>
#include <segue/distributed/gateways.hpp>
#include <segue/task_host/full_id.hpp>

#include <algorithm>
#include <iterator>
#include <tuple>
#include <utility>

namespace segue::distributed::detail {

namespace {

using Current = std::map<model::TaskId, model::DeploymentKey>;

/// The tasks of one site's view under the names that they have among all sites.
class Names {
 public:
  Names(const HostView& view, const Current& current) {
    std::map<model::TaskId, model::DeploymentKey> process_of;
    for (const auto& deployment : view.network.deployments) {
      for (const auto& placement : deployment.tasks) {
        process_of.emplace(placement.task, deployment.key());
      }
    }
    for (const auto& task : view.network.tasks) {
      const auto process = process_of.find(task.id);
      names_.emplace(task.id, fleet::detail::PlacementTable::name(
                                  current, task_host::plain_id(task.id),
                                  process == process_of.end() ? model::DeploymentKey{} : process->second));
    }
  }

  void rename(model::TaskId& task) const {
    const auto found = names_.find(task);
    if (found != names_.end()) {
      task = found->second;
    }
  }
  void rename(model::Connection& connection) const {
    rename(connection.from.task);
    rename(connection.to.task);
  }
  void rename(HostView& view) const {
    for (auto& deployment : view.network.deployments) {
      for (auto& placement : deployment.tasks) {
        rename(placement.task);
      }
    }
    for (auto& task : view.network.tasks) {
      rename(task.id);
    }
    for (auto& connection : view.network.connections) {
      rename(connection);
    }
    for (auto& report : view.tasks) {
      rename(report.id);
    }
    for (auto& report : view.connections) {
      rename(report.connection);
    }
  }

 private:
  std::map<model::TaskId, model::TaskId> names_;
};

template <class Item>
void move_to(std::vector<Item>& all, std::vector<Item>& some) {
  all.insert(all.end(), std::make_move_iterator(some.begin()), std::make_move_iterator(some.end()));
}

/// The order does not depend on how tasks are distributed.
void sort(HostView& view) {
  const auto by_id = [](const auto& a, const auto& b) { return a.id < b.id; };
  std::sort(view.network.tasks.begin(), view.network.tasks.end(), by_id);
  std::sort(view.tasks.begin(), view.tasks.end(), by_id);
  const auto identity = [](const model::Connection& one) { return std::tie(one.from, one.to, one.policy); };
  std::sort(view.network.connections.begin(), view.network.connections.end(),
            [&](const auto& a, const auto& b) { return identity(a) < identity(b); });
  std::sort(view.connections.begin(), view.connections.end(),
            [&](const auto& a, const auto& b) { return identity(a.connection) < identity(b.connection); });
}

}  // namespace

Result<HostLink::Reached> Site::reach() const {
  if (link_ == nullptr) {
    return HostLink::Reached{{std::shared_ptr<void>(), own_}, 0};
  }
  return link_->reach();
}

void Site::note(const Error& error, std::uint64_t number) const {
  if (link_ != nullptr) {
    link_->note(error, number);
  }
}

Sites::Sites(HostedRobot& own, std::vector<model::HostName> own_names, std::vector<HostPlace> hosts,
             std::function<void(const Error&)> lost)
    : loss_(std::move(lost)), own_names_(std::move(own_names)) {
  sites_.push_back(std::make_unique<Site>(model::kLocalHost, own));
  for (auto& host : hosts) {
    sites_.push_back(std::make_unique<Site>(std::move(host), pool_, loss_));
  }
}

Result<Site*> Sites::find(const model::HostName& host) const {
  if (host.empty() || host == model::kLocalHost ||
      std::find(own_names_.begin(), own_names_.end(), host) != own_names_.end()) {
    return sites_.front().get();
  }
  std::vector<std::string> names;
  for (const auto& site : sites_) {
    if (site->name() == host) {
      return site.get();
    }
    names.push_back(site->name().str());
  }
  return fail(ErrorCode::NotFound,
              "the robot has no host " + quote(host.str()) + did_you_mean(host.str(), names));
}

Result<Site*> Sites::locate(const model::TaskId& task, fleet::detail::Which which) const {
  const auto place = placements_.find(task, which);
  if (!place) {
    return place.error();
  }
  return find(place->process.host);
}

model::Network Sites::part(const model::Network& network, const Site& site) const {
  model::Network part;
  part.name = network.name;
  const auto processes = model::task_processes(network);
  const auto is_here = [&](const model::HostName& host) {
    const auto found = find(host);
    return found && *found == &site;
  };
  std::set<model::TaskId> here;
  for (const auto& task : network.tasks) {
    const auto process = processes.find(task.id);
    if (is_here(process == processes.end() ? model::kLocalHost : process->second.host)) {
      here.insert(task.id);
      part.tasks.push_back(task);
    }
  }
  std::copy_if(network.deployments.begin(), network.deployments.end(), std::back_inserter(part.deployments),
               [&](const model::Deployment& deployment) { return is_here(deployment.host); });
  std::copy_if(network.connections.begin(), network.connections.end(), std::back_inserter(part.connections),
               [&](const model::Connection& connection) {
                 return here.contains(connection.from.task) && here.contains(connection.to.task);
               });
  return part;
}

void Sites::for_all(const Work& work) const {
  std::vector<concurrent::ThreadPool::Job> jobs;
  for (const auto& site : sites_) {
    jobs.emplace_back([&work, &site = *site] {
      const auto reached = site.reach();
      if (!reached) {
        return;
      }
      if (const auto done = work(site, *reached->robot); !done) {
        site.note(done.error(), reached->number);
      }
    });
  }
  pool_.run_all(std::move(jobs));
}

Sites::Snapshot Sites::snapshot() const {
  const std::uint64_t poll = placements_.begin_poll();
  Mutex mutex;
  std::vector<Seen> all;
  for_all([&](const Site& site, HostedRobot& robot) -> Result<void> {
    auto view = robot.snapshot();
    if (!view) {
      return view.error();
    }
    const Lock lock(mutex);
    all.push_back({&site, std::move(*view)});
    return {};
  });
  for (const auto& seen : all) {
    learn(seen, poll);
  }
  const Current current = placements_.current();
  HostView merged;
  for (auto& [site, view] : all) {
    Names(view, current).rename(view);
    if (site->link() != nullptr) {
      site->link()->note(view);
    }
    move_to(merged.network.tasks, view.network.tasks);
    move_to(merged.network.deployments, view.network.deployments);
    move_to(merged.network.connections, view.network.connections);
    move_to(merged.tasks, view.tasks);
    move_to(merged.connections, view.connections);
  }
  sort(merged);
  return {std::move(merged), all.size() == sites_.size()};
}

void Sites::learn(const Seen& seen, std::uint64_t poll) const {
  std::map<model::DeploymentKey, std::set<model::TaskId>> tasks;
  if (seen.site->link() == nullptr) {
    tasks[model::DeploymentKey{}];
  }
  std::set<model::TaskId> placed;
  for (const auto& deployment : seen.view.network.deployments) {
    auto& there = tasks[deployment.key()];
    for (const auto& placement : deployment.tasks) {
      there.insert(task_host::plain_id(placement.task));
      placed.insert(placement.task);
    }
  }
  for (const auto& task : seen.view.network.tasks) {
    if (!placed.contains(task.id)) {
      tasks[model::DeploymentKey{}].insert(task_host::plain_id(task.id));
    }
  }
  std::set<model::DeploymentKey> now;
  for (const auto& [process, held] : tasks) {
    now.insert(process);
  }
  {
    const Lock lock(mutex_);
    auto& before = processes_[seen.site];
    for (const auto& process : before) {
      tasks[process];  // one that is gone holds nothing
    }
    before = std::move(now);
  }
  for (const auto& [process, held] : tasks) {
    placements_.update(process, held, poll);
  }
}

std::vector<task_host::TaskReport> Sites::with_lost(std::vector<task_host::TaskReport> reports) const {
  for (const auto& site : all()) {
    if (site->reachable()) {
      continue;
    }
    for (auto& report : site->link()->last_seen().tasks) {
      // The task may have been replaced on another host meanwhile.
      report.id = placements().name(task_host::plain_id(report.id), report.process);
      report.unknown = true;
      report.error = "unknown: host " + quote(site->name().str()) + " cannot be reached";
      reports.push_back(std::move(report));
    }
  }
  std::erase_if(reports, [](const task_host::TaskReport& report) { return is_link_task(report.id); });
  return reports;
}

}  // namespace segue::distributed::detail
