// SPDX-License-Identifier: Apache-2.0
#include "managed_peer.hpp"

#include <segue/ros2/parameter_value.hpp>

#include <chrono>

namespace ros2::testing {

using segue::type::Value;

namespace {

const Bytes kNoMessage = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};

/// Answers when the client gets responses, as servers of both middlewares do.
void respond(Peer& peer, const Request& request, const Bytes& response) {
  for (int i = 0; i < 1000 && peer.clients() == 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  peer.respond(request, response);
}

}  // namespace

ManagedPeer::ManagedPeer(const std::function<std::unique_ptr<Peer>()>& make_peer, std::string node,
                         std::function<void(int)> enters, bool tells)
    : node_(std::move(node)),
      enters_(std::move(enters)),
      change_state_(make_peer()),
      get_state_(make_peer()),
      set_parameters_(make_peer()),
      get_parameters_(tells ? make_peer() : nullptr) {
  serve();
  thread_ = std::thread([this] {
    for (; !ends_; std::this_thread::sleep_for(std::chrono::milliseconds(1))) {
      const bool hidden = hidden_;
      if (served_ == hidden) {
        if (hidden) {
          for (Peer* peer : peers())
            peer->stop_serving();
        } else {
          serve();
        }
        served_ = !hidden;
      }
      if (served_) answer();
    }
  });
}

ManagedPeer::~ManagedPeer() {
  ends_ = true;
  thread_.join();
}

void ManagedPeer::serve() {
  change_state_->serve(node_ + "/change_state", "lifecycle_msgs/srv/ChangeState");
  get_state_->serve(node_ + "/get_state", "lifecycle_msgs/srv/GetState");
  set_parameters_->serve(node_ + "/set_parameters_atomically", "rcl_interfaces/srv/SetParametersAtomically");
  if (get_parameters_) get_parameters_->serve(node_ + "/get_parameters", "rcl_interfaces/srv/GetParameters");
  for (Peer* peer : peers())
    peer->announce(node_.substr(1));
}

std::vector<Peer*> ManagedPeer::peers() const {
  std::vector<Peer*> all = {change_state_.get(), get_state_.get(), set_parameters_.get()};
  if (get_parameters_) all.push_back(get_parameters_.get());
  return all;
}

segue::ros2::MessageCodec ManagedPeer::codec(const std::string& message) {
  return segue::ros2::MessageCodec::of(library_, message).value();
}

void ManagedPeer::answer() {
  for (const Request& request : get_state_->requests()) {
    const Value state = Value::map({{"current_state", Value::map({{"id", int{state_}}})}});
    respond(*get_state_, request,
            fault_ == Fault::HasNoState ? kNoMessage : state_response_.encode(state, "").value());
  }
  answer_parameters();
  answer_changes();
}

void ManagedPeer::answer_parameters() {
  for (const Request& request : set_parameters_->requests()) {
    const Value asked = set_request_.decode(request.message).value();
    const segue::Lock lock(mutex_);
    bool fits = true;
    std::map<std::string, std::int64_t> wanted = values_;
    for (const Value& parameter : asked.find("parameters")->as_list()) {
      const std::string name = parameter.find("name")->as_string();
      fits = fits && name != "unknown";
      wanted[name] = parameter.find("value")->find("integer_value")->as_int();
      parameters_.push_back(name + ": " + std::to_string(wanted[name]));
    }
    if (fits) values_ = std::move(wanted);
    const Value result = Value::map(
        {{"successful", fits}, {"reason", fits ? "" : "parameter 'unknown' has not been declared"}});
    respond(*set_parameters_, request, set_response_.encode(Value::map({{"result", result}}), "").value());
  }
  if (!get_parameters_) return;
  for (const Request& request : get_parameters_->requests()) {
    const Value asked = get_request_.decode(request.message).value();
    respond(*get_parameters_, request, get_response_.encode(told(*asked.find("names")), "").value());
  }
}

/// As rclcpp's nodes: nothing where one of them is not declared.
Value ManagedPeer::told(const Value& names) const {
  Value::List values;
  const segue::Lock lock(mutex_);
  for (const Value& name : names.as_list()) {
    const auto known = values_.find(name.as_string());
    if (known == values_.end()) return Value::map({});
    values.push_back(*segue::ros2::parameter_value(Value(known->second)));
  }
  return Value::map({{"values", Value(std::move(values))}});
}

void ManagedPeer::answer_changes() {
  for (const Request& request : change_state_->requests()) {
    const Value asked = change_request_.decode(request.message).value();
    const int transition = static_cast<int>(asked.find("transition")->find("id")->as_int());
    {
      const segue::Lock lock(mutex_);
      transitions_.push_back(transition);
    }
    const Fault fault = fault_;
    if (fault == Fault::DiesInConfigure) {
      state_ = 10;
      hidden_ = true;
      return;
    }
    const bool fails = fault == Fault::FailsToActivate && transition == 3;
    if (fails) state_ = 1;
    const bool stays =
        fault == Fault::Refuses || fault == Fault::SaysDoneOnly || fault == Fault::AnswersNever;
    if (!fails && !stays) change(transition);
    if (fault == Fault::AnswersNever || (fault == Fault::AnswersNothing && transition == 3)) continue;
    if (fault == Fault::AnswersLate) std::this_thread::sleep_for(std::chrono::milliseconds(500));
    const Value response = Value::map({{"success", fault != Fault::Refuses && !fails}});
    respond(*change_state_, request,
            fault == Fault::Malformed ? kNoMessage : change_response_.encode(response, "").value());
  }
}

void ManagedPeer::change(int transition) {
  constexpr int kStates[] = {0, 2, 1, 3, 2};  // after configure, cleanup, activate, deactivate
  enters_(transition);
  state_ = kStates[transition];
}

std::int64_t ManagedPeer::value(const std::string& parameter) const {
  const segue::Lock lock(mutex_);
  const auto known = values_.find(parameter);
  return known == values_.end() ? 0 : known->second;
}

void ManagedPeer::set_value(const std::string& parameter, std::int64_t value) {
  const segue::Lock lock(mutex_);
  values_[parameter] = value;
}

std::vector<std::string> ManagedPeer::parameters() const {
  const segue::Lock lock(mutex_);
  return parameters_;
}

std::vector<int> ManagedPeer::transitions() const {
  const segue::Lock lock(mutex_);
  return transitions_;
}

}  // namespace ros2::testing
