// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/derived_messages.hpp>

#include <string>
#include <utility>

namespace segue::ros2 {

namespace {

FieldDefinition nested(std::string field, std::string message) {
  return {std::move(field), {.primitive = Primitive::Nested, .nested = std::move(message)}, {}};
}

FieldDefinition at_most_one(std::string field, std::string message) {
  return {std::move(field),
          {.primitive = Primitive::Nested,
           .nested = std::move(message),
           .multiplicity = Multiplicity::BoundedSequence,
           .capacity = 1},
          {}};
}

FieldDefinition goal_id() {
  return nested("goal_id", "unique_identifier_msgs/msg/UUID");
}

/// OMG IDL has no empty structures, so rosidl adds a field.
MessageDefinition named(MessageDefinition message, std::string name) {
  message.name = std::move(name);
  if (message.fields.empty())
    message.fields.push_back({"structure_needs_at_least_one_member", {.primitive = Primitive::Uint8}, {}});
  return message;
}

/// The event message is that of service introspection (REP-2012).
void add_service(const std::string& name, MessageDefinition request, MessageDefinition response,
                 std::vector<MessageDefinition>& all) {
  const std::string request_name = name + "_Request";
  const std::string response_name = name + "_Response";
  const std::string event_name = name + "_Event";
  all.push_back({name,
                 {nested("request_message", request_name), nested("response_message", response_name),
                  nested("event_message", event_name)}});
  all.push_back(named(std::move(request), request_name));
  all.push_back(named(std::move(response), response_name));
  all.push_back({event_name,
                 {nested("info", "service_msgs/msg/ServiceEventInfo"), at_most_one("request", request_name),
                  at_most_one("response", response_name)}});
}

void add_action(const std::string& name, std::vector<MessageDefinition> sections,
                std::vector<MessageDefinition>& all) {
  all.push_back({name,
                 {nested("goal", name + "_Goal"), nested("result", name + "_Result"),
                  nested("feedback", name + "_Feedback"), nested("send_goal_service", name + "_SendGoal"),
                  nested("get_result_service", name + "_GetResult"),
                  nested("feedback_message", name + "_FeedbackMessage")}});
  all.push_back(named(std::move(sections[0]), name + "_Goal"));
  all.push_back(named(std::move(sections[1]), name + "_Result"));
  all.push_back(named(std::move(sections[2]), name + "_Feedback"));
  add_service(
      name + "_SendGoal", {"", {goal_id(), nested("goal", name + "_Goal")}},
      {"",
       {{"accepted", {.primitive = Primitive::Bool}, {}}, nested("stamp", "builtin_interfaces/msg/Time")}},
      all);
  add_service(name + "_GetResult", {"", {goal_id()}},
              {"", {{"status", {.primitive = Primitive::Int8}, {}}, nested("result", name + "_Result")}},
              all);
  all.push_back({name + "_FeedbackMessage", {goal_id(), nested("feedback", name + "_Feedback")}});
}

}  // namespace

std::vector<MessageDefinition> messages_of(const InterfaceName& name,
                                           std::vector<MessageDefinition> sections) {
  std::vector<MessageDefinition> all;
  const std::string whole = to_string(name);
  if (name.kind == "msg") {
    all.push_back(named(std::move(sections[0]), whole));
  } else if (name.kind == "srv") {
    add_service(whole, std::move(sections[0]), std::move(sections[1]), all);
  } else {
    add_action(whole, std::move(sections), all);
  }
  return all;
}

}  // namespace segue::ros2
