// SPDX-License-Identifier: Apache-2.0
#include "node_peer.hpp"
#include "typed_peer.hpp"

#include <segue/ros2/parameter_value.hpp>
#include <segue/ros2/type_hash.hpp>

#include <utility>

namespace ros2::testing {

using segue::type::Value;

namespace {

Value::List all_parameters() {
  return parameter_messages(Value::map({{"frame", "lidar_link"},
                                        {"rate", 10},
                                        {"filter.gain", 2.0},
                                        {"serial", "A-17"},
                                        {"offsets", Value::list({0.5, 1.0})},
                                        {"use_sim_time", false}}));
}

Value description_of(const Value& parameter) {
  const std::string& name = parameter.find("name")->as_string();
  Value::List range;
  if (name == "rate") range.push_back(Value::map({{"from_value", 1}, {"to_value", 40}, {"step", 1}}));
  return Value::map({{"name", name},
                     {"type", *parameter.find("value")->find("type")},
                     {"description", name == "rate" ? "scans a second" : ""},
                     {"read_only", name == "serial"},
                     {"integer_range", Value(std::move(range))}});
}

}  // namespace

NodePeer::NodePeer(const std::function<std::unique_ptr<Peer>()>& make_peer, Fault fault)
    : topic_(make_peer()) {
  files_.write("lidar_msgs/msg/Sweep.msg", "std_msgs/Header header\nfloat32[<=720] ranges\n");
  library_ = segue::ros2::InterfaceLibrary({files_.folder()});
  hash_ = segue::ros2::type_hash(library_, "lidar_msgs/msg/Sweep").value();
  segue::ros2::Quality sensor;
  sensor.reliability = segue::ros2::Reliability::BestEffort;
  topic_->advertise({"/scan", "lidar_msgs/msg/Sweep", hash_, sensor});
  topic_->announce("lidar");
  services_.emplace(make_peer, "/lidar");
  serve(fault);
  services_->start();
}

NodePeer::~NodePeer() = default;

void NodePeer::serve(Fault fault) {
  services_->serve("get_state", "lifecycle_msgs/srv/GetState", [this](const Value&) {
    return Value::map({{"current_state", Value::map({{"id", state_.load()}})}});
  });
  services_->serve("change_state", "lifecycle_msgs/srv/ChangeState", [this](const Value& request) {
    constexpr int kStates[] = {0, 2, 1, 3, 2};  // after configure, cleanup, activate, deactivate
    state_ = kStates[request.find("transition")->find("id")->as_int()];
    return Value::map({{"success", true}});
  });
  services_->serve("get_type_description", "type_description_interfaces/srv/GetTypeDescription",
                   [this, fault](const Value&) { return type_response(fault); });
  services_->serve_parameters(all_parameters, description_of);
  services_->serve("set_parameters_atomically", "rcl_interfaces/srv/SetParametersAtomically",
                   [this](const Value& request) { return set_parameters(request); });
  if (fault == Fault::HidesParameters) services_->spoil("list_parameters", [](Value&) { return false; });
  if (fault == Fault::LosesParameters) {
    services_->spoil("get_parameters", [](Value& answer) {
      answer.as_map()["values"].as_list().pop_back();
      return true;
    });
  }
}

Value NodePeer::set_parameters(const Value& request) {
  segue::type::ValueMap all;
  for (const Value& parameter : request.find("parameters")->as_list())
    all.set(parameter.find("name")->as_string(), segue::ros2::parameter_from(*parameter.find("value")));
  const segue::Lock lock(mutex_);
  got_ = Value(std::move(all));
  return Value::map({{"result", Value::map({{"successful", true}})}});
}

Value NodePeer::got_parameters() {
  const segue::Lock lock(mutex_);
  return got_;
}

Value NodePeer::type_response(Fault fault) {
  Value response = type_response_of(library_, "lidar_msgs/msg/Sweep");
  if (fault == Fault::TellsAnotherType) {
    auto& told = response.as_map()["type_description"].as_map()["type_description"].as_map();
    told["fields"].as_list().pop_back();
  }
  return response;
}

}  // namespace ros2::testing
