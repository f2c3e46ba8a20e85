// SPDX-License-Identifier: Apache-2.0
#include <segue/rpc_codecs/model_wire.hpp>

#include <optional>
#include <utility>

namespace segue::control::detail {

namespace {

using model::ActionKind;
using model::TaskId;

using Numbers = std::vector<int>;

void encode_numbers(const Numbers& numbers, capnp::List<std::int32_t>::Builder builder) {
  for (unsigned i = 0; i < numbers.size(); ++i)
    builder.set(i, numbers[i]);
}

Numbers decode_numbers(capnp::List<std::int32_t>::Reader reader) {
  return decode_list<int>(reader, [](std::int32_t number) { return number; });
}

void encode_pair(const std::string& first, const std::string& second, wire::Pair::Builder builder) {
  builder.setFirst(as_text(first));
  builder.setSecond(as_text(second));
}

void encode_limits(const model::ResourceLimits& limits, wire::Limits::Builder builder) {
  if (limits.memory) builder.initMemory().setValue(*limits.memory);
  if (limits.open_files) builder.initOpenFiles().setValue(*limits.open_files);
  if (limits.cpu_time) builder.initCpuTime().setValue(static_cast<std::uint64_t>(limits.cpu_time->count()));
  if (limits.core) builder.initCore().setValue(*limits.core);
}

model::ResourceLimits decode_limits(wire::Limits::Reader reader) {
  model::ResourceLimits limits;
  if (reader.hasMemory()) limits.memory = reader.getMemory().getValue();
  if (reader.hasOpenFiles()) limits.open_files = reader.getOpenFiles().getValue();
  if (reader.hasCpuTime()) {
    limits.cpu_time = Duration(static_cast<std::int64_t>(reader.getCpuTime().getValue()));
  }
  if (reader.hasCore()) limits.core = reader.getCore().getValue();
  return limits;
}

std::uint8_t encode_policy(const std::optional<model::FailurePolicy>& policy) {
  return policy ? static_cast<std::uint8_t>(static_cast<unsigned>(*policy) + 1U) : std::uint8_t{0};
}

std::optional<model::FailurePolicy> decode_policy(std::uint8_t number) {
  if (number == 0) return std::nullopt;
  return enum_from(static_cast<std::uint8_t>(number - 1U), model::FailurePolicy::Fallback);
}

void encode_what(const model::TaskAction& what, wire::Action::Builder builder) {
  builder.setTask(as_text(what.task.str()));
}
void encode_what(const model::ConnectionAction& what, wire::Action::Builder builder) {
  encode(what.connection, builder.initConnection());
  builder.setAtOnce(what.at_once);
}
void encode_what(const model::DeploymentAction& what, wire::Action::Builder builder) {
  encode(what.deployment, builder.initDeployment());
  builder.setKill(what.kill);
}
void encode_what(const model::ConfigAction& what, wire::Action::Builder builder) {
  auto config = builder.initConfig();
  encode(what.definition, config.initDefinition());
  config.setHost(as_text(what.process.host.str()));
  config.setProcess(as_text(what.process.process.str()));
  config.setName(as_text(what.name));
}
void encode_what(const model::HandOverAction& what, wire::Action::Builder builder) {
  auto hand_over = builder.initHandOver();
  hand_over.setFrom(as_text(what.from.str()));
  hand_over.setTo(as_text(what.to.str()));
}
void encode_what(const model::CallAction& what, wire::Action::Builder builder) {
  auto call = builder.initCall();
  call.setTask(as_text(what.task.str()));
  call.setOperation(as_text(what.operation));
  put(what.arguments, call.initArguments());
}

model::ConfigAction decode_config(wire::Action::Config::Reader reader) {
  model::ConfigAction action;
  action.definition = decode(reader.getDefinition());
  action.process.host = model::HostName(as_string(reader.getHost()));
  action.process.process = model::ProcessName(as_string(reader.getProcess()));
  action.name = as_string(reader.getName());
  return action;
}

model::CallAction decode_call(wire::Action::Call::Reader reader) {
  return {TaskId(as_string(reader.getTask())), as_string(reader.getOperation()), get(reader.getArguments())};
}

wire::Action::Which subject_of(ActionKind kind) {
  switch (kind) {
    case ActionKind::Recover:
    case ActionKind::Stop:
    case ActionKind::Cleanup:
    case ActionKind::Configure:
    case ActionKind::Start:
      return wire::Action::TASK;
    case ActionKind::Disconnect:
    case ActionKind::Connect:
      return wire::Action::CONNECTION;
    case ActionKind::Undeploy:
    case ActionKind::Deploy:
      return wire::Action::DEPLOYMENT;
    case ActionKind::ApplyConfig:
      return wire::Action::CONFIG;
    case ActionKind::HandOver:
      return wire::Action::HAND_OVER;
    case ActionKind::CallOperation:
      break;
  }
  return wire::Action::CALL;
}

void decode_what(model::Action& action, wire::Action::Reader reader) {
  switch (reader.which()) {
    case wire::Action::TASK:
      action.what = model::TaskAction{TaskId(as_string(reader.getTask()))};
      return;
    case wire::Action::CONNECTION:
      action.what = model::ConnectionAction{decode(reader.getConnection()), reader.getAtOnce()};
      return;
    case wire::Action::DEPLOYMENT:
      action.what = model::DeploymentAction{decode(reader.getDeployment()), reader.getKill()};
      return;
    case wire::Action::CONFIG:
      action.what = decode_config(reader.getConfig());
      return;
    case wire::Action::HAND_OVER:
      action.what = model::HandOverAction{TaskId(as_string(reader.getHandOver().getFrom())),
                                          TaskId(as_string(reader.getHandOver().getTo()))};
      return;
    case wire::Action::CALL:
      action.what = decode_call(reader.getCall());
  }
}

}  // namespace

void encode(const Texts& texts, capnp::List<capnp::Text>::Builder builder) {
  for (unsigned i = 0; i < texts.size(); ++i)
    builder.set(i, as_text(texts[i]));
}

Texts decode(capnp::List<capnp::Text>::Reader reader) {
  return decode_list<std::string>(reader, [](capnp::Text::Reader text) { return as_string(text); });
}

void encode(const Activity& activity, wire::Activity::Builder builder) {
  builder.setTrigger(static_cast<std::uint8_t>(activity.trigger));
  builder.setScheduler(static_cast<std::uint8_t>(activity.scheduler));
  builder.setOptional(activity.optional);
  builder.setPriority(activity.priority);
  builder.setPeriod(activity.period.count());
  encode_numbers(activity.cpus, builder.initCpus(count_of(activity.cpus)));
  builder.setThread(as_text(activity.thread));
  builder.setUpdateDeadline(activity.update_deadline.count());
  builder.setSpin(activity.spin.count());
  encode(Texts(activity.triggers.begin(), activity.triggers.end()),
         builder.initTriggers(count_of(activity.triggers)));
}

Activity decode(wire::Activity::Reader reader) {
  Activity activity;
  activity.trigger = enum_from(reader.getTrigger(), Trigger::FileDescriptorDriven);
  activity.scheduler = enum_from(reader.getScheduler(), Scheduler::RoundRobin);
  activity.optional = reader.getOptional();
  activity.priority = reader.getPriority();
  activity.period = Duration(reader.getPeriod());
  activity.cpus = decode_numbers(reader.getCpus());
  activity.thread = as_string(reader.getThread());
  activity.update_deadline = Duration(reader.getUpdateDeadline());
  activity.spin = Duration(reader.getSpin());
  for (std::string& name : decode(reader.getTriggers()))
    activity.triggers.insert(std::move(name));
  return activity;
}

void encode(const model::PortRef& port, wire::PortRef::Builder builder) {
  builder.setTask(as_text(port.task.str()));
  builder.setPort(as_text(port.port));
}

model::PortRef decode(wire::PortRef::Reader reader) {
  return {TaskId(as_string(reader.getTask())), as_string(reader.getPort())};
}

void encode(const model::Connection& connection, wire::Connection::Builder builder) {
  builder.setFromTask(as_text(connection.from.task.str()));
  builder.setFromPort(as_text(connection.from.port));
  builder.setToTask(as_text(connection.to.task.str()));
  builder.setToPort(as_text(connection.to.port));
  builder.setKind(static_cast<std::uint8_t>(connection.policy.kind));
  builder.setTransport(static_cast<std::uint8_t>(connection.policy.transport));
  builder.setInit(connection.policy.init);
  builder.setSize(connection.policy.size);
}

model::Connection decode(wire::Connection::Reader reader) {
  model::Connection connection;
  connection.from = {TaskId(as_string(reader.getFromTask())), as_string(reader.getFromPort())};
  connection.to = {TaskId(as_string(reader.getToTask())), as_string(reader.getToPort())};
  connection.policy.kind = enum_from(reader.getKind(), BufferKind::CircularBuffer);
  connection.policy.transport = enum_from(reader.getTransport(), Transport::Dds);
  connection.policy.init = reader.getInit();
  connection.policy.size = reader.getSize();
  return connection;
}

void encode(const model::Task& task, wire::Task::Builder builder) {
  builder.setId(as_text(task.id.str()));
  builder.setComponent(as_text(task.component.str()));
  builder.setState(static_cast<std::uint8_t>(task.state));
  encode(task.config_names, builder.initConfigNames(count_of(task.config_names)));
  put(task.properties, builder.initProperties());
  if (task.activity) encode(*task.activity, builder.initActivity());
  encode(task.exclusive, builder.initExclusive(count_of(task.exclusive)));
  if (task.takes_over) builder.setTakesOver(as_text(task.takes_over->str()));
  builder.setOnFailure(encode_policy(task.on_failure));
}

model::Task decode(wire::Task::Reader reader) {
  model::Task task;
  task.id = TaskId(as_string(reader.getId()));
  task.component = model::ComponentName(as_string(reader.getComponent()));
  task.state = enum_from(reader.getState(), TaskState::Fatal);
  task.config_names = decode(reader.getConfigNames());
  task.properties = get(reader.getProperties());
  if (reader.hasActivity()) task.activity = decode(reader.getActivity());
  task.exclusive = decode(reader.getExclusive());
  if (reader.hasTakesOver()) task.takes_over = TaskId(as_string(reader.getTakesOver()));
  task.on_failure = decode_policy(reader.getOnFailure());
  return task;
}

void encode(const model::Deployment& deployment, wire::Deployment::Builder builder) {
  builder.setHost(as_text(deployment.host.str()));
  builder.setProcess(as_text(deployment.process.str()));
  encode_list(deployment.tasks, builder.initPlacements(count_of(deployment.tasks)),
              [](const model::Placement& placement, wire::Pair::Builder pair) {
                encode_pair(placement.task.str(), placement.name, pair);
              });
  builder.setDeployer(as_text(deployment.deployer));
  builder.setScheduler(static_cast<std::uint8_t>(deployment.scheduler));
  builder.setOptional(deployment.optional);
  builder.setPriority(deployment.priority);
  encode_numbers(deployment.cpus, builder.initCpus(count_of(deployment.cpus)));
  encode_list(deployment.environment, builder.initEnvironment(count_of(deployment.environment)),
              [](const std::pair<std::string, std::string>& entry, wire::Pair::Builder pair) {
                encode_pair(entry.first, entry.second, pair);
              });
  if (!deployment.limits.empty()) encode_limits(deployment.limits, builder.initLimits());
  builder.setOnFailure(encode_policy(deployment.on_failure));
  encode(deployment.libraries, builder.initLibraries(count_of(deployment.libraries)));
}

model::Deployment decode(wire::Deployment::Reader reader) {
  model::Deployment deployment;
  deployment.host = model::HostName(as_string(reader.getHost()));
  deployment.process = model::ProcessName(as_string(reader.getProcess()));
  deployment.tasks = decode_list<model::Placement>(reader.getPlacements(), [](wire::Pair::Reader pair) {
    return model::Placement{TaskId(as_string(pair.getFirst())), as_string(pair.getSecond())};
  });
  deployment.deployer = as_string(reader.getDeployer());
  deployment.scheduler = enum_from(reader.getScheduler(), Scheduler::RoundRobin);
  deployment.optional = reader.getOptional();
  deployment.priority = reader.getPriority();
  deployment.cpus = decode_numbers(reader.getCpus());
  deployment.environment =
      decode_list<std::pair<std::string, std::string>>(reader.getEnvironment(), [](wire::Pair::Reader pair) {
        return std::pair(as_string(pair.getFirst()), as_string(pair.getSecond()));
      });
  deployment.limits = decode_limits(reader.getLimits());
  deployment.on_failure = decode_policy(reader.getOnFailure());
  deployment.libraries = decode(reader.getLibraries());
  return deployment;
}

void encode(const model::Network& network, wire::Network::Builder builder) {
  const auto each = [](const auto& item, auto part) { encode(item, part); };
  builder.setName(as_text(network.name.str()));
  encode_list(network.tasks, builder.initTasks(count_of(network.tasks)), each);
  encode_list(network.deployments, builder.initDeployments(count_of(network.deployments)), each);
  encode_list(network.connections, builder.initConnections(count_of(network.connections)), each);
}

model::Network decode(wire::Network::Reader reader) {
  const auto each = [](const auto& part) { return decode(part); };
  model::Network network;
  network.name = model::NetworkName(as_string(reader.getName()));
  network.tasks = decode_list<model::Task>(reader.getTasks(), each);
  network.deployments = decode_list<model::Deployment>(reader.getDeployments(), each);
  network.connections = decode_list<model::Connection>(reader.getConnections(), each);
  return network;
}

void encode(const model::Action& action, wire::Action::Builder builder) {
  builder.setId(action.id);
  builder.setKind(static_cast<std::uint8_t>(action.kind));
  builder.setPhase(static_cast<std::uint8_t>(action.phase));
  if (!action.after.empty()) encode_numbers(action.after, builder.initAfter(count_of(action.after)));
  std::visit([&](const auto& what) { encode_what(what, builder); }, action.what);
}

model::Action decode(wire::Action::Reader reader) {
  model::Action action;
  action.id = reader.getId();
  action.kind = enum_from(reader.getKind(), ActionKind::CallOperation);
  action.phase = enum_from(reader.getPhase(), model::Phase::Retire);
  action.after = decode_numbers(reader.getAfter());
  if (reader.which() != subject_of(action.kind)) {
    throw WireError(fail(ErrorCode::ParseError, "an action has a subject of another kind of action"));
  }
  decode_what(action, reader);
  return action;
}

void encode(const model::Transition& transition, wire::Transition::Builder builder) {
  const auto each = [](const auto& item, auto part) { encode(item, part); };
  builder.setFrom(as_text(transition.from.str()));
  builder.setTo(as_text(transition.to.str()));
  builder.setOrder(static_cast<std::uint8_t>(transition.order));
  encode_list(transition.actions, builder.initActions(count_of(transition.actions)), each);
  auto removes = builder.initRemoves(count_of(transition.removes));
  for (unsigned i = 0; i < transition.removes.size(); ++i)
    removes.set(i, as_text(transition.removes[i].str()));
  encode_list(transition.redefines, builder.initRedefines(count_of(transition.redefines)), each);
}

model::Transition decode(wire::Transition::Reader reader) {
  const auto each = [](const auto& part) { return decode(part); };
  model::Transition transition;
  transition.from = model::NetworkName(as_string(reader.getFrom()));
  transition.to = model::NetworkName(as_string(reader.getTo()));
  transition.order = enum_from(reader.getOrder(), model::Order::Paper);
  transition.actions = decode_list<model::Action>(reader.getActions(), each);
  transition.removes = decode_list<TaskId>(reader.getRemoves(),
                                           [](capnp::Text::Reader task) { return TaskId(as_string(task)); });
  transition.redefines = decode_list<model::Task>(reader.getRedefines(), each);
  return transition;
}

}  // namespace segue::control::detail
