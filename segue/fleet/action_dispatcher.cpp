// SPDX-License-Identifier: Apache-2.0
#include <segue/fleet/action_dispatcher.hpp>

#include <segue/base/text.hpp>
#include <segue/fleet/action_ids.hpp>
#include <segue/model/action_times.hpp>
#include <segue/task_host/task_access.hpp>

#include <algorithm>
#include <numeric>

namespace segue::fleet::detail {

namespace {

using model::ActionKind;

/// How long a process may take to conclude a transition, which nothing waits for any more.
constexpr Duration kConcluding = std::chrono::seconds(2);

Error not_connected() {
  return fail(ErrorCode::NotFound, "is not connected, so it cannot be disconnected");
}

}  // namespace

Result<void> check_link(const model::Connection& connection, const model::DeploymentKey& from,
                        const model::DeploymentKey& to) {
  const auto ends = [&] {
    const auto end = [](const model::TaskId& task, const model::DeploymentKey& process) {
      return quote(task.str()) + " lives in " +
             (process.is_runtime() ? "the runtime's own process" : quote(to_string(process)));
    };
    return end(connection.from.task, from) + ", " + end(connection.to.task, to);
  };
  if (connection.policy.transport == Transport::Local) {
    return fail(ErrorCode::InvalidArgument, "'link: local' needs both tasks in one process, but " + ends() +
                                                "; leave the link out, or move one of them");
  }
  if (connection.policy.transport == Transport::Dds) {
    return fail(ErrorCode::Unsupported, "'link: dds' is for tasks on two computers, but " + ends() +
                                            " on this one; leave the link out");
  }
  return {};
}

std::map<RecordPtr, ActionDispatcher::Indices> ActionDispatcher::Plan::by_process() const {
  std::map<RecordPtr, Indices> indices = at_process;
  const auto add_connections = [&](const auto& connections, const Indices& of) {
    for (std::size_t i = 0; i < of.size(); ++i) {
      for (const RecordPtr& end : {connections[i].writer, connections[i].reader}) {
        if (end != nullptr) indices[end].push_back(of[i]);
      }
    }
  };
  add_connections(connect, connect_indices);
  add_connections(disconnect, disconnect_indices);
  for (const HandOver& what : hand_overs) {
    indices[what.from.record].push_back(what.index);
    indices[what.to.record].push_back(what.index);
  }
  return indices;
}

void ActionDispatcher::begin(std::vector<model::Action> actions, TimePoint deadline,
                             task_host::Completion completed) {
  Plan placed = plan(actions);
  const auto batch =
      std::make_shared<Batch>(std::move(actions), deadline, std::move(completed), std::move(placed));
  watch_silence(batch);
  for (const auto& [record, indices] : batch->plan.at_process) {
    begin_at(record, indices, batch);
  }
  begin_blocking(batch);
  if (!batch->plan.refused.empty()) {
    batch->add(batch->plan.refused);
  }
}

void ActionDispatcher::watch_silence(const BatchPtr& batch) {
  for (const auto& [process, indices] : batch->plan.by_process()) {
    if (process->key().is_runtime()) {
      continue;
    }
    batch->watches.push_back(std::make_shared<const std::function<void()>>(
        [weak = std::weak_ptr(batch), process = process, indices = indices] {
          const std::string why = silence_text(process->key(), process->process().pid);
          if (const auto there = weak.lock()) {
            there->fail(indices, fail(ErrorCode::DeadlineExceeded, why));
          }
        }));
    process->add(batch->watches.back());
  }
}

void ActionDispatcher::begin_blocking(const BatchPtr& batch) {
  for (const std::size_t index : batch->plan.processes) {
    batch->run(fleet_.pool(), index, [this, &action = batch->actions()[index], deadline = batch->deadline] {
      return perform_on_process(action, deadline);
    });
  }
  for (const auto& what : batch->plan.hand_overs) {
    batch->run(fleet_.pool(), what.index,
               [&what, deadline = batch->deadline] { return hand_over(what, deadline); });
  }
  if (!batch->plan.disconnect.empty() || !batch->plan.connect.empty()) {
    const auto connect = [this, batch] { begin_connections(batch); };
    if (!fleet_.pool().submit(connect)) {
      connect();  // it holds up this thread
    }
  }
}

void ActionDispatcher::begin_connections(const BatchPtr& batch) {
  // All are made together. How long each took is its share, unless together they were slow.
  const auto measure_all = [&](const Indices& indices, const auto& work) {
    if (indices.empty()) {
      return;
    }
    const TimePoint begin = RealClock::instance().now();
    std::vector<Result<void>> answers = work();
    const Duration all = RealClock::instance().now() - begin;
    const Duration share = all / static_cast<std::int64_t>(indices.size());
    std::vector<task_host::Completed> ended;
    for (std::size_t i = 0; i < indices.size(); ++i) {
      ended.push_back({indices[i], std::move(answers[i]), share < model::kQuickAction ? share : all});
    }
    batch->add(std::move(ended));
  };
  const Plan& plan = batch->plan;
  measure_all(plan.disconnect_indices,
              [&] { return connector_.disconnect(plan.disconnect, batch->deadline); });
  measure_all(plan.connect_indices, [&] { return connector_.connect(plan.connect, batch->deadline); });
}

ActionDispatcher::Plan ActionDispatcher::plan(const std::vector<model::Action>& actions) const {
  Plan plan;
  for (std::size_t i = 0; i < actions.size(); ++i) {
    if (auto placed = place(i, actions[i], plan); !placed) {
      plan.refused.push_back({i, std::move(placed)});
    }
  }
  return plan;
}

Result<void> ActionDispatcher::place(std::size_t index, const model::Action& action, Plan& plan) const {
  if (std::holds_alternative<model::DeploymentAction>(action.what)) {
    plan.processes.push_back(index);
    return {};
  }
  if (std::holds_alternative<model::ConnectionAction>(action.what)) {
    return place_connection(index, action, plan);
  }
  if (const auto* config = std::get_if<model::ConfigAction>(&action.what)) {
    return place_config(index, *config, plan);
  }
  if (const auto* what = std::get_if<model::HandOverAction>(&action.what)) {
    return place_hand_over(index, *what, plan);
  }
  auto located = fleet_.locate(*action.task(), which_of(action.kind));
  if (!located) {
    return std::move(located.error());
  }
  plan.at_process[located->record].push_back(index);
  return {};
}

Result<void> ActionDispatcher::place_hand_over(std::size_t index, const model::HandOverAction& what,
                                               Plan& plan) const {
  auto from = fleet_.locate(what.from, Which::Current);
  if (!from) {
    return std::move(from.error());
  }
  auto to = fleet_.locate(what.to, Which::Next);
  if (!to) {
    return std::move(to.error());
  }
  if (from->record != to->record) {
    plan.hand_overs.push_back({index, std::move(*from), std::move(*to)});
    return {};
  }
  if (from->task == to->task) {
    return fail(ErrorCode::InvalidState, "there is no other incarnation that it could take over from");
  }
  plan.at_process[from->record].push_back(index);
  return {};
}

Result<void> ActionDispatcher::hand_over(const HandOver& what, TimePoint deadline) {
  const auto giver = what.from.record->service();
  const auto taker = what.to.record->service();
  if (giver == nullptr || taker == nullptr) {
    return (giver == nullptr ? what.from : what.to).record->unreachable();
  }
  return task_host::hand_over_state({giver, what.from.task}, {taker, what.to.task}, deadline);
}

Result<void> ActionDispatcher::place_config(std::size_t index, const model::ConfigAction& what,
                                            Plan& plan) const {
  auto record = fleet_.find(what.process);
  if (record == nullptr) {
    return fail(ErrorCode::InvalidState,
                "process " + quote(to_string(what.process)) + " is not deployed; deploy it first");
  }
  if (auto free = fleet_.placements().free_place(what.definition.id, what.process); !free) {
    return std::move(free.error());
  }
  plan.at_process[record].push_back(index);
  return {};
}

Result<void> ActionDispatcher::place_connection(std::size_t index, const model::Action& action,
                                                Plan& plan) const {
  const auto& [connection, at_once] = std::get<model::ConnectionAction>(action.what);
  auto from = fleet_.locate(connection.from.task, which_of(action.kind));
  auto to = fleet_.locate(connection.to.task, which_of(action.kind));
  if (action.kind == ActionKind::Connect) {
    for (const auto* end : {&from, &to}) {
      if (!*end) {
        return end->error();
      }
    }
  } else if (!from && !to) {
    return not_connected();
  }
  const RecordPtr writer = from ? from->record : nullptr;
  const RecordPtr reader = to ? to->record : nullptr;
  const bool at_commit =
      action.kind == ActionKind::Connect && action.phase == model::Phase::Prepare && !at_once;
  if (at_commit) {
    commits_.note_waiting({writer, reader});
  }
  if (writer == reader) {
    plan.at_process[writer].push_back(index);
    return {};
  }
  if (action.kind == ActionKind::Disconnect) {
    plan.disconnect.push_back({plain(connection), writer, reader});
    plan.disconnect_indices.push_back(index);
    return {};
  }
  if (auto possible = check_link(connection, writer->key(), reader->key()); !possible) {
    return possible;
  }
  plan.connect.push_back({plain(connection), writer, reader, at_commit});
  plan.connect_indices.push_back(index);
  return {};
}

Result<void> ActionDispatcher::perform_on_process(const model::Action& action, TimePoint deadline) {
  const auto& [deployment, kill] = std::get<model::DeploymentAction>(action.what);
  if (action.kind == ActionKind::Deploy) {
    return fleet_.deploy(deployment, deadline);
  }
  return kill ? fleet_.kill(deployment.key(), deadline) : fleet_.undeploy(deployment.key(), deadline);
}

void ActionDispatcher::begin_at(const RecordPtr& record, const Indices& indices, const BatchPtr& batch) {
  const auto service = record->service();
  if (service == nullptr) {
    return batch->fail(indices, record->unreachable());
  }
  std::vector<model::Action> actions;
  for (const std::size_t index : indices) {
    actions.push_back(plain(batch->actions()[index]));
  }
  service->begin_all(std::move(actions), batch->deadline,
                     batch->part(indices, [this, record](const auto& action, const auto& outcome) {
                       note_placement(action, record, outcome);
                     }));
}

void ActionDispatcher::note_placement(const model::Action& action, const RecordPtr& record,
                                      const Result<void>& outcome) {
  const auto* config = std::get_if<model::ConfigAction>(&action.what);
  if (config == nullptr) {
    return;
  }
  const PlacementTable::Place place = PlacementTable::place_of(config->definition.id, record->key());
  if (record->ended()) {
    return;
  }
  if (outcome) {
    record->note_created(std::get<model::ConfigAction>(plain(action).what));
  }
  fleet_.placements().note_creation(place, outcome);
  if (record->ended()) {
    fleet_.placements().drop(place);  // it ended meanwhile, after its tasks were dropped or before
  }
}

void ActionDispatcher::withdraw() {
  commits_.give_up();
  fleet_.placements().withdraw();
}

void ActionDispatcher::conclude(const model::Transition& transition) {
  connector_.conclude();
  std::map<RecordPtr, model::Transition> parts;
  for (const auto& [task, process] : fleet_.placements().conclude()) {
    if (const auto record = fleet_.find(process)) {
      parts[record].removes.push_back(task);
    }
  }
  for (const auto& id : transition.removes) {
    if (const auto located = fleet_.locate(id)) {
      parts[located->record].removes.push_back(located->task);
    }
  }
  for (const auto& task : transition.redefines) {
    if (const auto located = fleet_.locate(task.id)) {
      auto& redefined = parts[located->record].redefines.emplace_back(task);
      redefined.id = located->task;
    }
  }
  const TimePoint deadline = RealClock::instance().now() + kConcluding;
  std::vector<concurrent::ThreadPool::Job> jobs;
  for (const auto& [record, part] : parts) {
    jobs.emplace_back([this, deadline, record = record, &part = part] {
      const auto service = record->service();
      if (service == nullptr || !service->conclude(part, deadline)) {
        return;  // the next snapshot says what it holds
      }
      for (const auto& task : part.removes) {
        fleet_.placements().drop({task, record->key()});
        record->note_removed(task);
      }
    });
  }
  fleet_.pool().run_all(std::move(jobs));
}

}  // namespace segue::fleet::detail
