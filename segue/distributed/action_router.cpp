// SPDX-License-Identifier: Apache-2.0
#include <segue/distributed/action_router.hpp>

#include <segue/base/text.hpp>
#include <segue/distributed/gateways.hpp>
#include <segue/fleet/action_ids.hpp>
#include <segue/task_host/full_id.hpp>
#include <segue/task_host/ordered_actions.hpp>
#include <segue/task_host/task_access.hpp>

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

namespace segue::distributed::detail {

namespace {

using fleet::detail::Which;
using fleet::detail::which_of;

/// The receivers that the transition leaves as they are.
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

/// The ids of all that an action has to wait for.
std::set<int> waits_for(int id, const std::map<int, const model::Action*>& actions) {
  std::set<int> all;
  std::vector<int> open{id};
  while (!open.empty()) {
    const auto action = actions.find(open.back());
    open.pop_back();
    if (action != actions.end()) {
      std::copy_if(action->second->after.begin(), action->second->after.end(), std::back_inserter(open),
                   [&](int before) { return all.insert(before).second; });
    }
  }
  return all;
}

/// Makes the receivers of link tasks wait for their senders: samples that a sender has taken are delivered
/// before its receivers stop and are disconnected, on other computers, unless the order of the actions has it
/// the other way round.
void let_receivers_wait(std::vector<model::Action>& actions) {
  struct Stop {
    int id = 0;
    std::set<int> waits_for;
  };
  std::map<int, const model::Action*> by_id;
  for (const auto& action : actions) {
    by_id.emplace(action.id, &action);
  }
  std::map<model::TaskId, Stop> stopped;
  for (const auto& action : actions) {
    if (action.kind == model::ActionKind::Stop && is_link_task(*action.task())) {
      stopped.emplace(*action.task(), Stop{action.id, waits_for(action.id, by_id)});
    }
  }
  for (auto& action : actions) {
    const auto* what = std::get_if<model::ConnectionAction>(&action.what);
    const bool disconnects = action.kind == model::ActionKind::Disconnect && what != nullptr;
    const auto sender = disconnects                              ? sender_of(what->connection.from.task)
                        : action.kind == model::ActionKind::Stop ? sender_of(*action.task())
                                                                 : std::nullopt;
    const auto first = sender ? stopped.find(*sender) : stopped.end();
    if (first != stopped.end() && !first->second.waits_for.contains(action.id)) {
      action.after.push_back(first->second.id);
    }
  }
}

}  // namespace

void ActionRouter::close() {
  Lock lock(mutex_);
  idle_.wait(mutex_, [this]() SEGUE_REQUIRES(mutex_) { return in_progress_ == 0; });
}

void ActionRouter::begin_transition(const model::Network& before, const model::Network& target) {
  auto kept = kept_receivers(before, target);
  std::map<const Site*, std::uint64_t> connections;
  for (const auto& site : sites_.all()) {
    if (const auto reached = site->reach()) {
      connections.emplace(site.get(), reached->number);
    }
  }
  const Lock lock(mutex_);
  connections_ = std::move(connections);
  kept_ = std::move(kept);
}

void ActionRouter::end_transition() {
  const Lock lock(mutex_);
  connections_.reset();
  kept_.clear();
}

bool ActionRouter::at_once(const model::Connection& connection) const {
  const Lock lock(mutex_);
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
  const Lock lock(mutex_);
  if (connections_) {
    const auto number = connections_->find(&site);
    if (number == connections_->end() || number->second != reached->number) {
      return fail(ErrorCode::Unavailable, "host " + quote(site.name().str()) +
                                              " was lost during the transition, and has given it up");
    }
  }
  return reached;
}

Result<Site*> ActionRouter::site_of(const model::TaskId& task, Which which) const {
  const auto wanted = which == Which::Next ? sites_.placements().wanted(task) : std::nullopt;
  return wanted ? sites_.find(wanted->host) : sites_.locate(task, which);
}

Result<Site*> ActionRouter::site_of(const model::Action& action, const model::Connection& connection) const {
  const Which which = which_of(action.kind);
  auto from = site_of(connection.from.task, which);
  const auto to = site_of(connection.to.task, which);
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

Result<Site*> ActionRouter::site_of(const model::HandOverAction& what) const {
  const auto from = site_of(what.from, Which::Current);
  const auto to = site_of(what.to, Which::Next);
  if (!from || !to) {
    return (from ? to : from).error();
  }
  return *from == *to ? *from : nullptr;
}

Result<Site*> ActionRouter::site_of(const model::Action& action) const {
  if (const auto* what = std::get_if<model::DeploymentAction>(&action.what)) {
    return sites_.find(what->deployment.host);
  }
  if (const auto* what = std::get_if<model::ConnectionAction>(&action.what)) {
    return site_of(action, what->connection);
  }
  if (const auto* what = std::get_if<model::HandOverAction>(&action.what)) {
    return site_of(*what);
  }
  if (const auto* what = std::get_if<model::ConfigAction>(&action.what)) {
    if (auto free = sites_.placements().free_place(what->definition.id, what->process); !free) {
      return std::move(free.error());
    }
    return sites_.find(what->process.host);
  }
  return site_of(*action.task(), which_of(action.kind));
}

void ActionRouter::perform(std::vector<model::Action> actions, Duration action_deadline,
                           const task_host::EarlyEnd& early_end, task_host::Completion completed) {
  let_receivers_wait(actions);
  task_host::OrderedActions::Performer performer;
  performer.begin = [this, action_deadline](std::vector<model::Action> some, TimePoint /*deadline*/,
                                            task_host::Completion ended) {
    begin(std::move(some), action_deadline, std::move(ended));
  };
  performer.observe = [this] { return sites_.snapshot().view.network; };
  performer.place = [this](const model::Action& action) -> const void* {
    const auto site = site_of(action);
    return site ? *site : nullptr;
  };
  performer.begin_no_more = [this] { begin_no_more(); };
  std::make_shared<task_host::OrderedActions>(std::move(actions), action_deadline, std::move(performer),
                                              std::move(completed))
      ->run(early_end);
}

void ActionRouter::begin_no_more() const {
  for (const auto& site : sites_.all()) {
    if (const auto reached = site->reach()) {
      reached->robot->begin_no_more();
    }
  }
}

void ActionRouter::begin(std::vector<model::Action> actions, Duration action_deadline,
                         task_host::Completion completed) {
  auto report = counted(actions.size(), std::move(completed));
  const auto batch = std::make_shared<task_host::SplitBatch>(std::move(actions), std::move(report));
  std::map<Site*, Indices> at_site;  // those that wait only for others there
  Indices hand_overs;
  std::vector<task_host::Completed> refused;
  for (std::size_t i = 0; i < batch->actions().size(); ++i) {
    const auto site = site_of(batch->actions()[i]);
    if (!site) {
      refused.push_back({i, site.error()});
    } else if (*site == nullptr) {
      hand_overs.push_back(i);
    } else {
      at_site[*site].push_back(i);
    }
  }
  for (const auto& [site, indices] : at_site) {
    begin_at(*site, indices, *batch, action_deadline);
  }
  for (const std::size_t index : hand_overs) {
    const auto& what = std::get<model::HandOverAction>(batch->actions()[index].what);
    batch->run(sites_.pool(), index, [this, &what, action_deadline] {
      return hand_over(what, RealClock::instance().now() + action_deadline);
    });
  }
  if (!refused.empty()) {
    batch->add(std::move(refused));
  }
}

task_host::Completion ActionRouter::counted(std::size_t actions, task_host::Completion completed) {
  {
    const Lock lock(mutex_);
    in_progress_ += actions;
  }
  return [this, completed = std::move(completed)](std::vector<task_host::Completed> ended) {
    const std::size_t count = ended.size();
    completed(std::move(ended));
    const Lock lock(mutex_);
    in_progress_ -= count;
    if (in_progress_ == 0) {
      idle_.notify_all();
    }
  };
}

void ActionRouter::begin_at(Site& site, const Indices& indices, task_host::SplitBatch& batch,
                            Duration action_deadline) {
  const auto reached = reach(site);
  if (!reached) {
    return batch.fail(indices, reached.error());
  }
  std::vector<model::Action> actions;
  for (const std::size_t index : indices) {
    actions.push_back(for_host(batch.actions()[index]));
  }
  reached->robot->begin_in_order(std::move(actions), action_deadline,
                                 batch.part(indices, [this](const auto& action, const auto& outcome) {
                                   note_placement(action, outcome);
                                 }));
}

Result<void> ActionRouter::hand_over(const model::HandOverAction& action, TimePoint deadline) const {
  const auto from = site_of(action.from, Which::Current);
  const auto to = site_of(action.to, Which::Next);
  if (!from || !to) {
    return (from ? to : from).error();
  }
  const auto giver = reach(**from);
  const auto taker = reach(**to);
  if (!giver || !taker) {
    return (giver ? taker : giver).error();
  }
  return task_host::hand_over_state({giver->robot, task_host::plain_id(action.from)},
                                    {taker->robot, task_host::plain_id(action.to)}, deadline);
}

void ActionRouter::note_placement(const model::Action& action, const Result<void>& outcome) const {
  const auto* config = std::get_if<model::ConfigAction>(&action.what);
  if (config == nullptr) {
    return;
  }
  sites_.placements().note_creation(
      fleet::detail::PlacementTable::place_of(config->definition.id, config->process), outcome);
}

}  // namespace segue::distributed::detail
