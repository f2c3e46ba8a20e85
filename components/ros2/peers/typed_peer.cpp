// SPDX-License-Identifier: Apache-2.0
#include "typed_peer.hpp"

#include <segue/ros2/type_hash.hpp>

#include <utility>

namespace ros2::testing {

using segue::type::Value;

namespace {

Value type_value(const segue::ros2::MessageDefinition& message) {
  Value::List fields;
  for (const auto& field : message.fields) {
    const int id = static_cast<int>(field.type.primitive) + static_cast<int>(field.type.multiplicity);
    fields.push_back(Value::map({{"name", field.name},
                                 {"type", Value::map({{"type_id", id},
                                                      {"capacity", field.type.capacity},
                                                      {"string_capacity", field.type.string_capacity},
                                                      {"nested_type_name", field.type.nested}})}}));
  }
  return Value::map({{"type_name", message.name}, {"fields", Value(std::move(fields))}});
}

}  // namespace

Value type_response_of(segue::ros2::InterfaceLibrary& library, const std::string& type) {
  const auto messages = library.with_parts(type).value();
  Value::List parts;
  for (std::size_t i = 1; i < messages.size(); ++i)
    parts.push_back(type_value(*messages[i]));
  return Value::map(
      {{"successful", true},
       {"type_description", Value::map({{"type_description", type_value(*messages.front())},
                                        {"referenced_type_descriptions", Value(std::move(parts))}})}});
}

TypedPeer::TypedPeer(const std::function<std::unique_ptr<Peer>()>& make_peer, Release release) {
  files_.write("dock_msgs/msg/Side.msg", "string name\n");
  files_.write("dock_msgs/srv/Ask.srv", "Side side\n---\n");
  files_.write("dock_msgs/action/Run.action", "Side side\n---\nbool docked\n---\nfloat32 distance\n");
  library_ = segue::ros2::InterfaceLibrary({files_.folder()});
  services_.emplace(make_peer, "/dock", segue::ros2::InterfaceLibrary({files_.folder()}));
  serve("ask", "dock_msgs/srv/Ask", release);
  if (release == Release::JazzyIntrospected)
    publish(make_peer, "/dock/ask/_service_event", "dock_msgs/srv/Ask_Event");
  const std::string action = "dock_msgs/action/Run";
  serve("run/_action/send_goal", action + "_SendGoal", release);
  serve("run/_action/get_result", action + "_GetResult", release);
  publish(make_peer, "/dock/run/_action/feedback", action + "_FeedbackMessage");
  registered_[hash(action)] = action;
  services_->serve("get_type_description", "type_description_interfaces/srv/GetTypeDescription",
                   [this](const Value& request) { return tell(request.find("type_hash")->as_string()); });
  services_->start();
}

TypedPeer::~TypedPeer() = default;

std::string TypedPeer::hash(const std::string& type) {
  return segue::ros2::type_hash(library_, type).value();
}

void TypedPeer::serve(const std::string& name, const std::string& type, Release release) {
  registered_[hash(type)] = type;
  ServiceHashes hashes{hash(type + "_Request"), hash(type + "_Response")};
  if (release == Release::Lyrical || release == Release::Wrong) hashes.whole = hash(type);
  if (release == Release::Wrong) hashes.response = hash("std_msgs/msg/String");
  services_->serve(
      name, type, [](const Value&) { return std::nullopt; }, hashes);
}

void TypedPeer::publish(const std::function<std::unique_ptr<Peer>()>& make_peer, const std::string& topic,
                        const std::string& type) {
  registered_[hash(type)] = type;
  topics_.push_back(make_peer());
  topics_.back()->advertise({topic, type, hash(type)});
  topics_.back()->announce("dock");
}

Value TypedPeer::tell(const std::string& hash) {
  const auto type = registered_.find(hash);
  if (type != registered_.end()) return type_response_of(library_, type->second);
  return Value::map({{"successful", false}, {"failure_reason", "Type not currently in use by this node"}});
}

}  // namespace ros2::testing
