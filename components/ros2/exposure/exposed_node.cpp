// SPDX-License-Identifier: Apache-2.0
#include "exposed_node.hpp"
#include "exposed_parameters.hpp"
#include "exposed_states.hpp"

#include <chrono>

namespace ros2 {

using segue::Result;
using segue::type::Value;

namespace {

std::uint64_t time_of_day() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(now).count());
}

}  // namespace

ExposedNode::ExposedNode(std::shared_ptr<Participant> participant, std::string name,
                         std::shared_ptr<ExposedTask> task)
    : participant_(std::move(participant)), name_(std::move(name)), task_(std::move(task)) {
  const std::size_t slash = name_.rfind('/');
  entities_.name_space = slash == 0 ? "/" : name_.substr(0, slash);
  entities_.name = name_.substr(slash + 1);
}

Result<std::unique_ptr<ExposedNode>> ExposedNode::make(const std::shared_ptr<Participant>& participant,
                                                       ServiceExecutor& executor, const std::string& name,
                                                       std::shared_ptr<ExposedTask> task,
                                                       const segue::ros2::Gid& parameter_events) {
  std::unique_ptr<ExposedNode> made(new ExposedNode(participant, name, std::move(task)));
  made->entities_.publishers.push_back(parameter_events);
  if (auto opened = made->open(executor); !opened) return opened.error();
  participant->announce(made->entities_);
  return made;
}

ExposedNode::~ExposedNode() {
  participant_->withdraw(entities_);
}

Result<void> ExposedNode::open(ServiceExecutor& executor) {
  segue::ros2::InterfaceLibrary library;
  auto events = MessageWriter::make(participant_, library, name_ + "/transition_event",
                                    "lifecycle_msgs/msg/TransitionEvent", {});
  if (!events) return events.error();
  events_ = std::move(*events);
  entities_.publishers.push_back(events_->gid());
  Answers answers;
  add_parameter_services(answers);
  add_lifecycle_services(answers);
  if (task_->is_writable()) add_operations(answers);
  for (auto& [service, answer] : answers) {
    auto opened = executor.open(library, service, std::move(answer));
    if (!opened) return opened.error();
    entities_.publishers.push_back(ServiceExecutor::publisher(**opened));
    entities_.subscriptions.push_back(ServiceExecutor::subscription(**opened));
    services_.push_back(std::move(*opened));
  }
  return {};
}

void ExposedNode::set_state(segue::TaskState state) {
  const segue::TaskState before = task_->state();
  task_->set_state(state);
  for (const Value& event : transition_events(before, state, time_of_day()))
    events_->publish(event);
}

void ExposedNode::add(Answers& answers, const std::string& name, const std::string& interface,
                      ServiceExecutor::Answer answer) const {
  answers.push_back({{name_ + "/" + name, interface, name_}, std::move(answer)});
}

void ExposedNode::add_parameter_services(Answers& answers) const {
  const auto task = task_;
  add(answers, "list_parameters", "rcl_interfaces/srv/ListParameters",
      [task](const Value& request) { return list_parameters(parameters_of(task->report()), request); });
  add(answers, "get_parameters", "rcl_interfaces/srv/GetParameters",
      [task](const Value& request) { return get_parameters(parameters_of(task->report()), request); });
  add(answers, "get_parameter_types", "rcl_interfaces/srv/GetParameterTypes",
      [task](const Value& request) { return get_parameter_types(parameters_of(task->report()), request); });
  add(answers, "describe_parameters", "rcl_interfaces/srv/DescribeParameters",
      [task](const Value& request) { return task->describe(request); });
  add(answers, "set_parameters", "rcl_interfaces/srv/SetParameters",
      [task](const Value& request) { return task->set_parameters(request); });
  add(answers, "set_parameters_atomically", "rcl_interfaces/srv/SetParametersAtomically",
      [task](const Value& request) { return task->set_parameters_atomically(request); });
}

void ExposedNode::add_lifecycle_services(Answers& answers) const {
  const auto task = task_;
  add(answers, "get_state", "lifecycle_msgs/srv/GetState", [task](const Value&) {
    return Value::map({{"current_state", lifecycle_state(task->state())}});
  });
  add(answers, "get_available_states", "lifecycle_msgs/srv/GetAvailableStates", [](const Value&) {
    return Value::map({{"available_states", Value(lifecycle_states())}});
  });
  // None: the controller decides.
  add(answers, "get_available_transitions", "lifecycle_msgs/srv/GetAvailableTransitions", [](const Value&) {
    return Value::map({{"available_transitions", Value(Value::List())}});
  });
  // A service of this name has the same interface.
  add(answers, "get_transition_graph", "lifecycle_msgs/srv/GetAvailableTransitions", [](const Value&) {
    return Value::map({{"available_transitions", Value(lifecycle_transitions())}});
  });
  add(answers, "change_state", "lifecycle_msgs/srv/ChangeState",
      [task](const Value& request) { return task->change_state(request); });
}

void ExposedNode::add_operations(Answers& answers) const {
  for (const std::string& operation : task_->operations()) {
    add(answers, operation, "std_srvs/srv/Trigger",
        [task = task_, operation](const Value&) { return task->call(operation); });
  }
}

}  // namespace ros2
