// SPDX-License-Identifier: Apache-2.0
#include <segue/hosts/action_router.hpp>

#include <segue/base/text.hpp>
#include <segue/deploy/action_ids.hpp>
#include <segue/host/full_id.hpp>
#include <segue/hosts/gateways.hpp>

#include <map>
#include <utility>

namespace segue::hosts::detail {

namespace {

using deploy::detail::Which;
using deploy::detail::which_of;

/// Those receivers that go on as they are.
std::set<model::TaskId> kept_receivers(const model::Network& before, const model::Network& target) {
  const auto processes_before = model::task_processes(before);
  const auto processes = model::task_processes(target);
  std::map<model::TaskId, const model::Task*> tasks;
  for (const auto& task : before.tasks) {
    tasks.emplace(task.id, &task);
  }
  std::set<model::TaskId> kept;
  for (const auto& task : target.tasks) {
    const auto was = tasks.find(task.id);
    if (!sender_of(task.id) || was == tasks.end()) {
      continue;
    }
    const auto process_before = processes_before.find(task.id);
    const auto process = processes.find(task.id);
    const bool moves = process_before == processes_before.end() || process == processes.end() ||
                       process_before->second != process->second;
    if (!moves && was->second->state == task.state && was->second->same_configuration(task)) {
      kept.insert(task.id);
    }
  }
  return kept;
}

}  // namespace

void ActionRouter::close() {
  std::unique_lock lock(mutex_);
  idle_.wait(lock, [this] { return in_progress_ == 0; });
}

void ActionRouter::begin_transition(const model::Network& before, const model::Network& target) {
  auto kept = kept_receivers(before, target);
  std::map<const Site*, std::uint64_t> connections;
  for (const auto& site : sites_.all()) {
    if (const auto reached = site->reach()) {
      connections.emplace(site.get(), reached->number);
    }
  }
  const std::lock_guard lock(mutex_);
  connections_ = std::move(connections);
  kept_ = std::move(kept);
}

void ActionRouter::end_transition() {
  const std::lock_guard lock(mutex_);
  connections_.reset();
  kept_.clear();
}

bool ActionRouter::at_once(const model::Connection& connection) const {
  const std::lock_guard lock(mutex_);
  return is_link_task(connection.from.task) && !kept_.contains(connection.from.task);
}

model::Action ActionRouter::for_host(model::Action action) const {
  if (auto* what = std::get_if<model::ConnectionAction>(&action.what)) {
    what->at_once = at_once(what->connection);
  }
  return action;
}

Result<HostLink::Reached> ActionRouter::reach(const Site& site) const {
  auto reached = site.reach();
  if (!reached) {
    return reached;
  }
  const std::lock_guard lock(mutex_);
  if (connections_) {
    const auto number = connections_->find(&site);
    if (number == connections_->end() || number->second != reached->number) {
      return fail(ErrorCode::Unavailable, "host " + quote(site.name().str()) +
                                              " was lost during the transition, and has given it up");
    }
  }
  return reached;
}

Result<Site*> ActionRouter::site_of(const model::Action& action, const model::Connection& connection) const {
  const Which which = which_of(action.kind);
  const auto from = sites_.locate(connection.from.task, which);
  const auto to = sites_.locate(connection.to.task, which);
  if (!from || !to) {
    // To disconnect, one end is enough: that of the other one is gone with its process.
    const auto& there = from ? from : to;
    return action.kind == model::ActionKind::Disconnect ? there : (from ? to : from);
  }
  if (*from != *to) {
    return fail(ErrorCode::InvalidArgument,
                quote(connection.from.task.str()) + " lives on host " + quote((*from)->name().str()) + ", " +
                    quote(connection.to.task.str()) + " on host " + quote((*to)->name().str()) +
                    "; only whole controllers can have connections between hosts");
  }
  return from;
}

Result<Site*> ActionRouter::site_of(const model::Action& action) const {
  if (const auto* what = std::get_if<model::DeploymentAction>(&action.what)) {
    return sites_.find(what->deployment.host);
  }
  if (const auto* what = std::get_if<model::ConnectionAction>(&action.what)) {
    return site_of(action, what->connection);
  }
  if (const auto* what = std::get_if<model::ConfigAction>(&action.what)) {
    if (auto free = sites_.placements().free_place(what->definition.id, what->process); !free) {
      return std::move(free.error());
    }
    return sites_.find(what->process.host);
  }
  return sites_.locate(*action.task(), which_of(action.kind));
}

Result<void> ActionRouter::place(std::size_t index, Batch& batch) const {
  const model::Action& action = batch.actions[index];
  if (const auto* what = std::get_if<model::HandOverAction>(&action.what)) {
    const auto from = sites_.locate(what->from, Which::Current);
    const auto to = sites_.locate(what->to, Which::Next);
    if (!from || !to) {
      return (from ? to : from).error();
    }
    if (*from != *to) {
      batch.hand_overs.push_back({index, *from, *to});
      return {};
    }
  }
  const auto site = site_of(action);
  if (!site) {
    return site.error();
  }
  batch.at_site[*site].push_back(index);
  return {};
}

void ActionRouter::begin(std::vector<model::Action> actions, TimePoint deadline, host::Completion completed) {
  const auto batch =
      std::make_shared<Batch>(Batch{std::move(actions), deadline, std::move(completed), {}, {}, {}});
  {
    const std::lock_guard lock(mutex_);
    in_progress_ += batch->actions.size();
  }
  std::vector<host::Completed> refused;
  for (std::size_t i = 0; i < batch->actions.size(); ++i) {
    if (auto placed = place(i, *batch); !placed) {
      Error error = std::move(placed.error());
      if (error.subject.empty()) {
        error.subject = batch->actions[i].label();
      }
      refused.push_back({i, std::move(error)});
    }
  }
  defer_receivers(*batch);
  for (const auto& [site, indices] : batch->at_site) {
    begin_at(*site, indices, batch);
  }
  for (const auto& what : batch->hand_overs) {
    begin_hand_over(what, batch);
  }
  if (!refused.empty()) {
    report(batch, std::move(refused));
  }
}

void ActionRouter::defer_receivers(Batch& batch) {
  std::map<model::TaskId, std::size_t> stopped;
  for (const auto& [site, indices] : batch.at_site) {
    for (const std::size_t index : indices) {
      const auto& action = batch.actions[index];
      if (action.kind == model::ActionKind::Stop && is_link_task(*action.task())) {
        stopped.emplace(*action.task(), index);
      }
    }
  }
  const auto waits_for = [&](const model::Action& action) {
    const auto* what = std::get_if<model::ConnectionAction>(&action.what);
    const bool disconnects = action.kind == model::ActionKind::Disconnect && what != nullptr;
    const auto sender = disconnects                              ? sender_of(what->connection.from.task)
                        : action.kind == model::ActionKind::Stop ? sender_of(*action.task())
                                                                 : std::nullopt;
    return sender ? stopped.find(*sender) : stopped.end();
  };
  for (auto& [site, indices] : batch.at_site) {
    std::erase_if(indices, [&, site = site](std::size_t index) {
      const auto first = waits_for(batch.actions[index]);
      if (first == stopped.end()) {
        return false;
      }
      batch.afterwards[first->second][site].push_back(index);
      return true;
    });
  }
  std::erase_if(batch.at_site, [](const auto& item) { return item.second.empty(); });
}

void ActionRouter::report(const BatchPtr& batch, std::vector<host::Completed> ended) {
  std::vector<std::size_t> indices;
  for (const auto& one : ended) {
    indices.push_back(one.index);
  }
  batch->completed(std::move(ended));
  for (const std::size_t index : indices) {
    const auto next = batch->afterwards.find(index);
    if (next == batch->afterwards.end()) {
      continue;
    }
    for (const auto& [site, later] : next->second) {
      begin_at(*site, later, batch);
    }
  }
  const std::lock_guard lock(mutex_);
  in_progress_ -= indices.size();
  if (in_progress_ == 0) {
    idle_.notify_all();
  }
}

void ActionRouter::begin_at(Site& site, const Indices& indices, const BatchPtr& batch) {
  const auto reached = reach(site);
  if (!reached) {
    std::vector<host::Completed> failed;
    for (const std::size_t index : indices) {
      Error error = reached.error();
      error.subject = batch->actions[index].label();
      failed.push_back({index, std::move(error)});
    }
    return report(batch, std::move(failed));
  }
  std::vector<model::Action> actions;
  for (const std::size_t index : indices) {
    actions.push_back(for_host(batch->actions[index]));
  }
  // The batch owns the indices.
  reached->robot->begin_all(std::move(actions), batch->deadline,
                            [this, batch, &indices](std::vector<host::Completed> ended) {
                              for (auto& one : ended) {
                                one.index = indices[one.index];
                                note_placement(batch->actions[one.index], one.outcome);
                              }
                              report(batch, std::move(ended));
                            });
}

void ActionRouter::begin_hand_over(const HandOver& what, const BatchPtr& batch) {
  const auto job = [this, batch, &what] {
    const TimePoint begin = RealClock::instance().now();
    const auto& action = std::get<model::HandOverAction>(batch->actions[what.index].what);
    auto outcome = hand_over(what, action, batch->deadline);
    report(batch, {{what.index, std::move(outcome), RealClock::instance().now() - begin}});
  };
  if (!sites_.pool().submit(job)) {
    job();
  }
}

Result<void> ActionRouter::hand_over(const HandOver& what, const model::HandOverAction& action,
                                     TimePoint deadline) const {
  const auto giver = reach(*what.from);
  const auto taker = reach(*what.to);
  if (!giver || !taker) {
    return (giver ? taker : giver).error();
  }
  const auto state = giver->robot->save_state(host::plain_id(action.from), deadline);
  if (!state) {
    return state.error();
  }
  return state->has_value() ? taker->robot->restore_state(host::plain_id(action.to), **state, deadline)
                            : Result<void>();
}

void ActionRouter::note_placement(const model::Action& action, const Result<void>& outcome) const {
  const auto* config = std::get_if<model::ConfigAction>(&action.what);
  if (config == nullptr) {
    return;
  }
  const auto place = deploy::detail::PlacementTable::place_of(config->definition.id, config->process);
  if (outcome) {
    sites_.placements().put(place);
  } else if (outcome.error().code == ErrorCode::DeadlineExceeded ||
             outcome.error().code == ErrorCode::Unavailable) {
    sites_.placements().put_unconfirmed(place);
  }
}

}  // namespace segue::hosts::detail
