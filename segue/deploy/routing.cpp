// SPDX-License-Identifier: Apache-2.0
#include <segue/deploy/routing.hpp>

#include <segue/base/text.hpp>
#include <segue/host/full_id.hpp>
#include <segue/model/action_times.hpp>

#include <algorithm>
#include <numeric>

namespace segue::deploy::detail {

namespace {

using model::ActionKind;

/// How long a process may take to conclude a transition, which nothing waits for any more.
constexpr Duration kConcluding = std::chrono::seconds(2);

template <class Work>
host::Completed measured(std::size_t index, Work work) {
  const TimePoint begin = RealClock::instance().now();
  auto outcome = work();
  return {index, std::move(outcome), RealClock::instance().now() - begin};
}

Error not_connected() {
  return fail(ErrorCode::NotFound, "is not connected, so it cannot be disconnected");
}

Error with_subject(Error error, const std::string& subject) {
  if (error.subject.empty()) {
    error.subject = subject;
  }
  return error;
}

Which which_of(ActionKind kind) {
  switch (kind) {
    case ActionKind::Recover:
    case ActionKind::Stop:
    case ActionKind::Cleanup:
    case ActionKind::Disconnect:
      return Which::Current;
    default:
      return Which::Next;
  }
}

/// As processes know it: by plain ids.
model::Connection plain(model::Connection connection) {
  connection.from.task = host::plain_id(connection.from.task);
  connection.to.task = host::plain_id(connection.to.task);
  return connection;
}

model::Action plain(model::Action action) {
  if (auto* task = std::get_if<model::TaskAction>(&action.what)) {
    task->task = host::plain_id(task->task);
  } else if (auto* call = std::get_if<model::CallAction>(&action.what)) {
    call->task = host::plain_id(call->task);
  } else if (auto* config = std::get_if<model::ConfigAction>(&action.what)) {
    config->definition.id = host::plain_id(config->definition.id);
  } else if (auto* hand_over = std::get_if<model::HandOverAction>(&action.what)) {
    hand_over->from = host::plain_id(hand_over->from);
    hand_over->to = host::plain_id(hand_over->to);
  } else if (auto* wire = std::get_if<model::ConnectionAction>(&action.what)) {
    wire->connection = plain(std::move(wire->connection));
  }
  return action;
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

void Router::perform(std::span<const model::Action> actions, TimePoint deadline,
                     const host::Completion& completed) {
  // Shared with calls under way: the last of them may still be on its way out when all are told.
  const auto outcomes = std::make_shared<host::BatchOutcomes>(
      actions.size(), [actions, &completed](std::vector<host::Completed> ended) {
        for (auto& one : ended) {
          if (!one.outcome) {
            one.outcome = with_subject(std::move(one.outcome.error()), actions[one.index].label());
          }
        }
        completed(std::move(ended));
      });
  const Plan plan = this->plan(actions, outcomes);
  Services services;
  for (const auto& [record, indices] : plan.at_process) {
    services.push_back(begin_at(record, indices, actions, deadline, outcomes));
  }
  fleet_.pool().run_all(blocking(plan, actions, deadline, outcomes));
  outcomes->tell();
  outcomes->wait();
}

std::vector<WorkerPool::Job> Router::blocking(const Plan& plan, std::span<const model::Action> actions,
                                              TimePoint deadline, const Outcomes& outcomes) {
  std::vector<WorkerPool::Job> jobs;
  for (const std::size_t index : plan.processes) {
    jobs.emplace_back([this, actions, deadline, outcomes, index] {
      outcomes->add({measured(index, [&] { return perform_on_process(actions[index], deadline); })});
    });
  }
  for (const auto& what : plan.hand_overs) {
    jobs.emplace_back([&what, deadline, outcomes] {
      outcomes->add({measured(what.index, [&] { return hand_over(what, deadline); })});
    });
  }
  // All are laid together: of one that is quick, its share is its time.
  const auto spread = [](host::BatchOutcomes& to, const Indices& indices, const auto& work) {
    const TimePoint begin = RealClock::instance().now();
    std::vector<Result<void>> answers = work();
    const Duration all = RealClock::instance().now() - begin;
    const Duration share = all / static_cast<std::int64_t>(std::max<std::size_t>(indices.size(), 1));
    std::vector<host::Completed> ended;
    for (std::size_t i = 0; i < indices.size(); ++i) {
      ended.push_back({indices[i], std::move(answers[i]), share < model::kQuickAction ? share : all});
    }
    to.add(std::move(ended));
  };
  if (!plan.disconnect.empty() || !plan.connect.empty()) {
    jobs.emplace_back([this, &plan, deadline, outcomes, spread] {
      spread(*outcomes, plan.disconnect_indices,
             [&] { return connector_.disconnect(plan.disconnect, deadline); });
      spread(*outcomes, plan.connect_indices, [&] { return connector_.connect(plan.connect, deadline); });
    });
  }
  return jobs;
}

Router::Plan Router::plan(std::span<const model::Action> actions, const Outcomes& outcomes) const {
  Plan plan;
  for (std::size_t i = 0; i < actions.size(); ++i) {
    if (auto placed = place(i, actions[i], plan); !placed) {
      outcomes->note({i, std::move(placed)});
    }
  }
  return plan;
}

Result<void> Router::place(std::size_t index, const model::Action& action, Plan& plan) const {
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

Result<void> Router::place_hand_over(std::size_t index, const model::HandOverAction& what, Plan& plan) const {
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

Result<void> Router::hand_over(const HandOver& what, TimePoint deadline) {
  const auto giver = what.from.record->service();
  const auto taker = what.to.record->service();
  if (giver == nullptr || taker == nullptr) {
    return (giver == nullptr ? what.from : what.to).record->unreachable();
  }
  const auto state = giver->save_state(what.from.task, deadline);
  if (!state) {
    return state.error();
  }
  return state->has_value() ? taker->restore_state(what.to.task, **state, deadline) : Result<void>();
}

Result<void> Router::place_config(std::size_t index, const model::ConfigAction& what, Plan& plan) const {
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

Result<void> Router::place_connection(std::size_t index, const model::Action& action, Plan& plan) const {
  const auto& connection = std::get<model::ConnectionAction>(action.what).connection;
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
  plan.connect.push_back({plain(connection), writer, reader});
  plan.connect_indices.push_back(index);
  return {};
}

Result<void> Router::perform_on_process(const model::Action& action, TimePoint deadline) {
  const auto& [deployment, kill] = std::get<model::DeploymentAction>(action.what);
  if (action.kind == ActionKind::Deploy) {
    return fleet_.deploy(deployment, deadline);
  }
  return kill ? fleet_.kill(deployment.key(), deadline) : fleet_.undeploy(deployment.key(), deadline);
}

std::shared_ptr<DeploymentService> Router::begin_at(const RecordPtr& record, const Indices& indices,
                                                    std::span<const model::Action> actions,
                                                    TimePoint deadline, const Outcomes& outcomes) {
  auto service = record->service();
  Indices asked;
  std::vector<model::Action> batch;
  for (const std::size_t index : indices) {
    if (service == nullptr) {
      outcomes->note({index, record->unreachable()});
      continue;
    }
    asked.push_back(index);
    batch.push_back(plain(actions[index]));
  }
  if (!batch.empty()) {
    service->begin_all(std::move(batch), deadline,
                       [this, record, actions, asked, outcomes](std::vector<host::Completed> ended) {
                         for (auto& one : ended) {
                           one.index = asked[one.index];
                           note_placement(actions[one.index], record, one.outcome);
                         }
                         outcomes->add(std::move(ended));
                       });
  }
  return service;
}

void Router::note_placement(const model::Action& action, const RecordPtr& record,
                            const Result<void>& outcome) {
  const auto* config = std::get_if<model::ConfigAction>(&action.what);
  if (config == nullptr) {
    return;
  }
  const PlacementTable::Place place = PlacementTable::place_of(config->definition.id, record->key());
  if (outcome) {
    record->note_created(std::get<model::ConfigAction>(plain(action).what));
    fleet_.placements().put(place);
  } else if (outcome.error().code == ErrorCode::DeadlineExceeded ||
             outcome.error().code == ErrorCode::Unavailable) {
    fleet_.placements().put_unconfirmed(place);
  }
}

void Router::withdraw() {
  fleet_.placements().withdraw();
}

void Router::conclude(const model::Transition& transition) {
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
  std::vector<WorkerPool::Job> jobs;
  for (const auto& [record, part] : parts) {
    jobs.emplace_back([this, deadline, record = record, &part = part] {
      const auto service = record->service();
      if (service == nullptr || !service->conclude(part, deadline)) {
        return;  // the next look says what it holds
      }
      for (const auto& task : part.removes) {
        fleet_.placements().drop({task, record->key()});
        record->note_removed(task);
      }
    });
  }
  fleet_.pool().run_all(std::move(jobs));
}

}  // namespace segue::deploy::detail
