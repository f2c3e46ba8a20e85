// SPDX-License-Identifier: Apache-2.0
#include "node_interview.hpp"
#include "../nodes/lifecycle_client.hpp"
#include "../services/requester.hpp"

#include <segue/ros2/parameter_value.hpp>
#include <segue/ros2/type_hash.hpp>
#include <segue/ros2/used_interfaces.hpp>

#include <algorithm>
#include <map>
#include <string>
#include <utility>

namespace ros2 {
namespace {

using segue::ErrorCode;
using segue::fail;
using segue::Result;
using segue::ros2::TypeHashes;
using segue::type::Value;
using segue::type::ValueMap;

/// The questions to one node.
class Questions {
 public:
  Questions(const Interview& interview, ValueMap& node)
      : interview_(interview), node_(node), end_(segue::Deadline(interview.patience)) {
    // All at once, since a server finds each client only after a while.
    if (node_.find("managed")->as_bool()) open("get_state", "lifecycle_msgs/srv/GetState");
    if (offers("list_parameters")) {
      open("list_parameters", "rcl_interfaces/srv/ListParameters");
      open("get_parameters", "rcl_interfaces/srv/GetParameters");
      open("describe_parameters", "rcl_interfaces/srv/DescribeParameters");
    }
    if (interview_.types && offers("get_type_description"))
      open("get_type_description", "type_description_interfaces/srv/GetTypeDescription");
  }

  void ask_state() {
    if (!node_.find("managed")->as_bool()) return;
    const auto answer = call("get_state", Value());
    if (!answer) note("state: " + segue::to_string(answer.error()));
    const auto state = answer ? answer->find("current_state")->find("id")->as_int() : 0;
    node_.set("state", answer ? to_string(static_cast<NodeState>(state)) : std::string_view());
  }

  void ask_parameters() {
    auto parameters = offers("list_parameters") ? read_parameters() : Value::List();
    if (!parameters) note("parameters: " + segue::to_string(parameters.error()));
    node_.set("parameters", parameters ? Value(std::move(*parameters)) : Value(Value::List()));
  }

  void ask_types() {
    ValueMap files;
    for (const auto& [name, hashes] : segue::ros2::used_interfaces(Value(node_))) {
      if (is_built_in(name, hashes)) continue;
      auto told = ask_type(name, hashes);
      if (!told) {
        note(segue::to_string(told.error()));
        continue;
      }
      for (auto& file : *told)
        files.set(file.path, std::move(file.text));
    }
    node_.set("files", Value(std::move(files)));
  }

  Value problems() { return Value(std::move(problems_)); }

 private:
  void note(std::string text) { problems_.emplace_back(std::move(text)); }

  [[nodiscard]] std::string path(const std::string& service) const {
    return node_.find("name")->as_string() + "/" + service;
  }

  [[nodiscard]] bool offers(const std::string& service) const {
    for (const Value& one : node_.find("services")->as_list()) {
      if (one.find("name")->as_string() == path(service)) return true;
    }
    return false;
  }

  void open(const std::string& service, const std::string& interface) {
    segue::ros2::InterfaceLibrary library;
    auto requester = Requester::make(interview_.participant, library, path(service), interface);
    if (requester) (*requester)->allow(true);
    requesters_.emplace(service, std::move(requester));
  }

  Result<Value> call(const std::string& service, const Value& request) {
    const auto& requester = requesters_.at(service);
    if (!requester) return requester.error();
    const std::stop_callback ended(interview_.stop, [&] { (*requester)->allow(false); });
    return (*requester)->call(request, end_);
  }

  Result<Value::List> read_parameters() {
    auto listed = call("list_parameters", Value());
    if (!listed) return listed.error();
    const Value names = *listed->find("result")->find("names");
    if (names.as_list().empty()) return Value::List();
    const Value request = Value::map({{"names", names}});
    auto values = call("get_parameters", request);
    if (!values) return values.error();
    auto descriptions = call("describe_parameters", request);
    if (!descriptions) return descriptions.error();
    const Value::List& given = values->find("values")->as_list();
    const Value::List& described = descriptions->find("descriptors")->as_list();
    if (given.size() != names.as_list().size() || described.size() != given.size())
      return fail(ErrorCode::InvalidState,
                  "the node has changed them meanwhile, or does not answer for each");
    Value::List all;
    for (std::size_t i = 0; i < given.size(); ++i)
      all.push_back(parameter(names.as_list()[i], given[i], described[i]));
    return all;
  }

  static Value parameter(const Value& name, const Value& value, const Value& descriptor) {
    ValueMap map;
    map.set("name", name);
    map.set("kind", segue::ros2::parameter_kind(value.find("type")->as_int()));
    map.set("value", segue::ros2::parameter_from(value));
    map.set("read_only", *descriptor.find("read_only"));
    map.set("description", *descriptor.find("description"));
    map.set("constraints", *descriptor.find("additional_constraints"));
    for (const char* kind : {"floating_point_range", "integer_range"}) {
      const auto& range = descriptor.find(kind)->as_list();
      if (range.empty()) continue;
      map.set("range", Value::map({{"from", *range.front().find("from_value")},
                                   {"to", *range.front().find("to_value")},
                                   {"step", *range.front().find("step")}}));
    }
    return Value(std::move(map));
  }

  /// Without a hash, by its name.
  static bool is_built_in(const std::string& type, const TypeHashes& hashes) {
    segue::ros2::InterfaceLibrary library;
    return library.find(type) && std::ranges::all_of(hashes, [&](const auto& hash) {
             const auto own = segue::ros2::type_hash(library, hash.first);
             return own && *own == hash.second;
           });
  }

  Result<std::vector<segue::ros2::InterfaceFile>> ask_type(const std::string& type,
                                                           const TypeHashes& hashes) {
    const auto parts = segue::ros2::parts_to_ask(type, hashes);
    if (parts.empty() || !offers("get_type_description")) {
      const bool is_message = type.find("/msg/") != std::string::npos;
      return fail(ErrorCode::Unsupported,
                  "type " + type + " is not built in, and the node does not tell it, as nodes do from " +
                      (is_message ? "Jazzy" : "Lyrical") +
                      " on: name a folder with its package under `interfaces`");
    }
    segue::ros2::ToldInterfaces told;
    for (const std::string& part : parts) {
      const auto answer =
          call("get_type_description", Value::map({{"type_name", part}, {"type_hash", hashes.at(part)}}));
      if (!answer) return answer.error();
      if (auto added = told.add(*answer, part); !added) return added.error();
    }
    return told.files(type, hashes);
  }

  const Interview& interview_;
  ValueMap& node_;
  const segue::TimePoint end_;
  std::map<std::string, Result<std::unique_ptr<Requester>>> requesters_;  ///< by service
  Value::List problems_;
};

}  // namespace

void ask(const Interview& interview, ValueMap& node) {
  Questions questions(interview, node);
  questions.ask_state();
  questions.ask_parameters();
  if (interview.types) questions.ask_types();
  node.set("problems", questions.problems());
}

}  // namespace ros2
