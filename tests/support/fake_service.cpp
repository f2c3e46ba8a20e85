// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>

#include <support/fake_world.hpp>

#include <algorithm>

namespace segue::deploy::testing {

namespace {

using model::ActionKind;

Error no_such(const std::string& what) {
  return fail(ErrorCode::NotFound, "no " + what + " here");
}

}  // namespace

template <class T, class Effect>
Result<T> FakeService::answer(const std::string& what, Effect effect) const {
  const auto verdict = world_.judge(what, process_);
  Result<T> answer = fail(ErrorCode::Internal, "no answer");
  if (verdict.take_effect) {
    const Lock lock(world_.mutex);
    answer = effect();
  }
  if (verdict.die_afterwards) {
    world_.kill(process_);
    return fail(ErrorCode::Unavailable, "injected");
  }
  return verdict.answer ? Result<T>(*verdict.answer) : std::move(answer);
}

template <class T, class Question, class Effect>
std::vector<Result<T>> FakeService::answer_all(const std::string& what, std::span<const Question> questions,
                                               Effect effect) {
  std::vector<Result<T>> answers;
  auto whole = answer<std::vector<Result<T>>>(what, [&] {
    std::vector<Result<T>> each;
    for (const auto& question : questions) {
      each.push_back(effect(question));
    }
    return each;
  });
  if (whole) {
    return std::move(*whole);
  }
  for (std::size_t i = 0; i < questions.size(); ++i) {
    answers.push_back(whole.error());
  }
  return answers;
}

Result<DeploymentInfo> FakeService::info() {
  return answer<DeploymentInfo>("info", [&]() -> Result<DeploymentInfo> {
    return DeploymentInfo{"robot", process_->deployment, process_->info.pid, "0.1.0", process_->incarnation};
  });
}

Result<Snapshot> FakeService::snapshot() {
  return answer<Snapshot>("snapshot", [&]() -> Result<Snapshot> {
    Snapshot snapshot;
    model::Deployment deployment = process_->deployment;
    for (const auto& [id, task] : process_->tasks) {
      const bool hangs = process_->hanging.contains(id);
      snapshot.network.tasks.push_back(task);
      if (hangs) snapshot.network.tasks.back().state = TaskState::Fatal;
      deployment.tasks.push_back({id, id.str()});
      task_host::TaskReport report;
      report.id = id;
      report.state = snapshot.network.tasks.back().state;
      if (hangs) report.error = "on_update has not returned within 5 s";
      snapshot.tasks.push_back(report);
    }
    snapshot.network.deployments.push_back(deployment);
    for (const auto& connection : process_->connections) {
      if (process_->carries(connection)) {
        snapshot.network.connections.push_back(connection);
        snapshot.connections.push_back({connection, 0, 0, 0});
      }
    }
    snapshot.endpoints = process_->endpoints;
    for (auto& endpoint : snapshot.endpoints) {
      endpoint.carries = process_->carries(endpoint);
    }
    snapshot.hanging.assign(process_->hanging.begin(), process_->hanging.end());
    return snapshot;
  });
}

Result<void> FakeService::expect(const model::Network& /*network*/) {
  return answer<void>("expect", [] { return Result<void>(); });
}

void FakeService::begin_all(std::vector<model::Action> actions, TimePoint /*deadline*/,
                            task_host::Completion completed) {
  if (world_.pretends()) {
    std::vector<task_host::Completed> done;
    for (std::size_t i = 0; i < actions.size(); ++i) {
      done.push_back({i, {}});
    }
    return completed(std::move(done));
  }
  auto outcomes = answer_all<void>("perform", std::span<const model::Action>(actions),
                                   [&](const model::Action& action) { return act(action); });
  std::vector<task_host::Completed> ended;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    ended.push_back({i, std::move(outcomes[i])});
  }
  completed(std::move(ended));
}

Result<void> FakeService::act(const model::Action& action) {
  if (const auto* config = std::get_if<model::ConfigAction>(&action.what)) {
    const auto& definition = config->definition;
    const auto found = process_->tasks.find(definition.id);
    const TaskState state = found == process_->tasks.end() ? TaskState::PreOperational : found->second.state;
    process_->tasks[definition.id] = definition;
    process_->tasks[definition.id].state = state;
    return {};
  }
  if (std::holds_alternative<model::ConnectionAction>(action.what)) {
    return act_on_connection(action);
  }
  const auto found = action.task() == nullptr ? process_->tasks.end() : process_->tasks.find(*action.task());
  return found == process_->tasks.end() ? Result<void>(no_such("task")) : act_on_task(action, found->second);
}

Result<void> FakeService::act_on_task(const model::Action& action, model::Task& task) {
  const auto from_to = [&](TaskState from, TaskState to) -> Result<void> {
    if (task.state != from) {
      return fail(ErrorCode::InvalidState, "is " + std::string(to_string(task.state)));
    }
    task.state = to;
    return {};
  };
  switch (action.kind) {
    case ActionKind::Configure:
      return from_to(TaskState::PreOperational, TaskState::Stopped);
    case ActionKind::Start:
      return from_to(TaskState::Stopped, TaskState::Running);
    case ActionKind::Stop:
      return from_to(TaskState::Running, TaskState::Stopped);
    case ActionKind::Cleanup:
      return from_to(TaskState::Stopped, TaskState::PreOperational);
    case ActionKind::Recover:
      return from_to(TaskState::Exception, TaskState::PreOperational);
    default:
      return {};
  }
}

Result<void> FakeService::act_on_connection(const model::Action& action) {
  const auto& connection = std::get<model::ConnectionAction>(action.what).connection;
  auto& all = process_->connections;
  const auto found = std::find(all.begin(), all.end(), connection);
  if (action.kind == ActionKind::Connect) {
    if (!process_->tasks.contains(connection.from.task) || !process_->tasks.contains(connection.to.task)) {
      return no_such("task");
    }
    const bool has_ended = std::erase(process_->ended, connection) > 0;
    if (found != all.end() && !has_ended) {
      return fail(ErrorCode::AlreadyExists, "is already connected");
    }
    std::erase(all, connection);  // it has ended with an earlier transition
    all.push_back(connection);
    if (action.phase == model::Phase::Prepare) {
      process_->dormant.push_back(connection);
    }
  } else if (found == all.end()) {
    return no_such("connection");
  } else {
    all.erase(found);
    std::erase(process_->ended, connection);
  }
  return {};
}

Result<void> FakeService::arm_commit(const ArmCommit& what, TimePoint /*deadline*/) {
  return answer<void>("arm_commit", [&]() -> Result<void> {
    for (const auto& connection : std::exchange(process_->ended, {})) {
      std::erase(process_->connections, connection);
    }
    process_->ending = what;
    process_->gate = std::make_shared<task::CommitGate>();
    process_->gate->arm(what.page->word(what.number), what.number);
    return {};
  });
}

Result<void> FakeService::settle(TimePoint /*deadline*/) {
  return answer<void>("settle", [&]() -> Result<void> {
    const bool committed = process_->committed();
    for (const auto& connection : process_->dormant) {
      if (!committed) {
        std::erase(process_->connections, connection);
      }
    }
    for (const auto& connection : process_->connections) {
      if (!process_->carries(connection) && committed) {
        process_->ended.push_back(connection);
      }
    }
    for (auto& endpoint : process_->endpoints) {
      endpoint.carries = process_->carries(endpoint);
    }
    process_->dormant.clear();
    process_->ending = {};
    process_->gate.reset();
    return {};
  });
}

Result<void> FakeService::conclude(const model::Transition& transition, TimePoint /*deadline*/) {
  return answer<void>("conclude", [&]() -> Result<void> {
    for (const auto& id : transition.removes) {
      const auto found = process_->tasks.find(id);
      if (found != process_->tasks.end() && !is_configured(found->second.state)) {
        process_->tasks.erase(found);
        forget_connections_of(id);
      }
    }
    for (const auto& definition : transition.redefines) {
      const auto found = process_->tasks.find(definition.id);
      if (found != process_->tasks.end()) {
        const TaskState state = found->second.state;
        found->second = definition;
        found->second.state = state;
      }
    }
    return {};
  });
}

void FakeService::forget_connections_of(const model::TaskId& task) {
  std::erase_if(process_->connections, [&](const model::Connection& connection) {
    return connection.from.task == task || connection.to.task == task;
  });
  std::erase_if(process_->endpoints, [&](const EndpointReport& endpoint) {
    const auto& own = endpoint.side == Side::Output ? endpoint.connection.from : endpoint.connection.to;
    return own.task == task;
  });
}

Result<std::optional<task::SavedState>> FakeService::save_state(const model::TaskId& task,
                                                                TimePoint /*deadline*/) {
  return answer<std::optional<task::SavedState>>(
      "save_state", [&]() -> Result<std::optional<task::SavedState>> {
        const auto found = process_->states.find(task);
        return found == process_->states.end() ? std::nullopt : std::optional(found->second);
      });
}

Result<void> FakeService::restore_state(const model::TaskId& task, const task::SavedState& state,
                                        TimePoint /*deadline*/) {
  return answer<void>("restore_state", [&]() -> Result<void> {
    if (!process_->tasks.contains(task)) {
      return no_such("task");
    }
    process_->states.insert_or_assign(task, state);
    return {};
  });
}

Result<model::ComponentModel> FakeService::describe(const model::TaskId& task) const {
  return answer<model::ComponentModel>("describe", [&]() -> Result<model::ComponentModel> {
    model::ComponentModel model;
    model.doc = process_->info.key.process.str() + '/' + task.str();
    return model;
  });
}

Result<type::Value> FakeService::properties(const model::TaskId& task) const {
  return answer<type::Value>("properties", [&]() -> Result<type::Value> { return type::Value(task.str()); });
}

/// At once: whoever waits for changes asks another fake.
void FakeService::watch(const task_host::LevelQuestion& question, const Wait& /*wait*/,
                        task_host::LevelAnswer answered) {
  answered(answer<task_host::TaskLevel>("watch", [&]() -> Result<task_host::TaskLevel> {
    task_host::TaskLevel level;
    level.state_name = process_->info.key.process.str() + '/' + question.task.str();
    return level;
  }));
}

Result<task_host::TaskDetails> FakeService::details(const model::TaskId& task) const {
  return answer<task_host::TaskDetails>("details", [&]() -> Result<task_host::TaskDetails> {
    task_host::TaskDetails details;
    details.timing.updates.counts[0] = task.str().size();
    return details;
  });
}

Result<void> FakeService::set_property(const model::TaskId& /*task*/, std::string_view /*path*/,
                                       const type::Value& /*value*/, TimePoint /*deadline*/) {
  return answer<void>("set_property", [] { return Result<void>(); });
}

/// A link finds all its counterparts; other operations return their arguments.
Result<type::Value> FakeService::call(const model::TaskId& /*task*/, std::string_view operation,
                                      const type::Value& arguments, TimePoint /*deadline*/) {
  return answer<type::Value>("call", [&]() -> Result<type::Value> {
    return operation == "wait_matched" ? *arguments.find("count") : arguments;
  });
}

Result<void> FakeService::write(const model::PortRef& /*port*/, const type::Value& /*value*/,
                                TimePoint /*deadline*/) {
  return fail(ErrorCode::Unsupported, "fakes have no samples");
}

Result<std::unique_ptr<task_host::PortReader>> FakeService::open_reader(const model::PortRef& /*port*/,
                                                                        std::size_t /*buffer*/) {
  return fail(ErrorCode::Unsupported, "fakes have no samples");
}

Result<sample_link::MemoryOffer> FakeService::memory(TimePoint /*deadline*/) {
  return answer<sample_link::MemoryOffer>("memory", [&]() -> Result<sample_link::MemoryOffer> {
    sample_link::MemoryOffer offer;
    offer.incarnation = process_->incarnation;
    return offer;
  });
}

Result<void> FakeService::admit(const sample_link::MemoryOffer& peer, TimePoint /*deadline*/) {
  return answer<void>("admit", [&]() -> Result<void> {
    process_->admitted.insert(peer.incarnation);
    return {};
  });
}

Result<void> FakeService::forget(sample_link::Incarnation peer) {
  return answer<void>("forget", [&]() -> Result<void> {
    process_->admitted.erase(peer);
    std::erase_if(process_->endpoints, [&](const EndpointReport& endpoint) { return endpoint.peer == peer; });
    return {};
  });
}

std::vector<Result<sample_link::OutputOrigin>> FakeService::describe_outputs(
    std::span<const model::PortRef> ports, TimePoint /*deadline*/) {
  return answer_all<sample_link::OutputOrigin>(
      "describe_outputs", ports, [&](const model::PortRef& port) -> Result<sample_link::OutputOrigin> {
        if (!process_->tasks.contains(port.task)) {
          return no_such("task");
        }
        sample_link::OutputOrigin origin;
        origin.writer = process_->incarnation;
        origin.sample_size = port.port == kPortWithoutType ? 0 : 8;
        return origin;
      });
}

std::vector<Result<sample_link::InputPlace>> FakeService::open_inputs(std::span<const OpenInput> inputs,
                                                                      TimePoint /*deadline*/) {
  return answer_all<sample_link::InputPlace>(
      "open_inputs", inputs, [&](const OpenInput& input) -> Result<sample_link::InputPlace> {
        if (!process_->admitted.contains(input.origin.writer)) {
          return fail(ErrorCode::InvalidState, "the writer has not been admitted");
        }
        if (!process_->tasks.contains(input.connection.to.task)) {
          return no_such("task");
        }
        for (const auto& endpoint : process_->endpoints) {
          if (endpoint.side == Side::Input && endpoint.connection == input.connection &&
              endpoint.peer == input.origin.writer) {
            return fail(ErrorCode::AlreadyExists, "is already connected");
          }
        }
        EndpointReport endpoint{input.connection, Side::Input, input.origin.writer, {}, {}};
        endpoint.place.reader = process_->incarnation;
        endpoint.place.offset = world_.next_place();
        endpoint.place.generation = 1;
        endpoint.carries = !input.at_commit;
        process_->endpoints.push_back(endpoint);
        return endpoint.place;
      });
}

std::vector<Result<void>> FakeService::attach_outputs(std::span<const AttachOutput> outputs,
                                                      TimePoint /*deadline*/) {
  return answer_all<void>("attach_outputs", outputs, [&](const AttachOutput& output) -> Result<void> {
    if (!process_->admitted.contains(output.place.reader)) {
      return fail(ErrorCode::InvalidState, "the reader has not been admitted");
    }
    if (!process_->tasks.contains(output.connection.from.task)) {
      return no_such("task");
    }
    for (const auto& endpoint : process_->endpoints) {
      if (endpoint.side == Side::Output && endpoint.connection == output.connection &&
          endpoint.peer == output.place.reader) {
        return fail(ErrorCode::AlreadyExists, "is already connected");
      }
    }
    process_->endpoints.push_back({output.connection, Side::Output, output.place.reader, output.place, {}});
    process_->endpoints.back().carries = !output.at_commit;
    return {};
  });
}

std::vector<Result<void>> FakeService::close_endpoints(std::span<const CloseEndpoint> endpoints,
                                                       TimePoint /*deadline*/) {
  return answer_all<void>("close_endpoints", endpoints, [&](const CloseEndpoint& close) -> Result<void> {
    const auto erased = std::erase_if(process_->endpoints, [&](const EndpointReport& endpoint) {
      return endpoint.side == close.side && endpoint.connection == close.connection &&
             endpoint.peer == close.peer;
    });
    return erased == 0 ? Result<void>(no_such("endpoint")) : Result<void>();
  });
}

void FakeService::set_listener(Listener listener) {
  const Lock lock(world_.mutex);
  process_->listener = std::move(listener);
}

}  // namespace segue::deploy::testing
