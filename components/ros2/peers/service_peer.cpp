// SPDX-License-Identifier: Apache-2.0
#include "service_peer.hpp"

#include <segue/ros2/message_codec.hpp>
#include <segue/ros2/parameter_value.hpp>

#include <algorithm>
#include <chrono>
#include <utility>

namespace ros2::testing {

using segue::type::Value;

namespace {

/// A list of what `of` makes of each parameter that the request names.
Value of_named(const Value& request, const Value::List& parameters, const char* field,
               const std::function<Value(const Value& parameter)>& of) {
  Value::List all;
  for (const Value& name : request.find("names")->as_list()) {
    for (const Value& parameter : parameters) {
      if (*parameter.find("name") == name) all.push_back(of(parameter));
    }
  }
  return Value::map({{field, Value(std::move(all))}});
}

}  // namespace

Value::List parameter_messages(const Value& parameters) {
  return segue::ros2::parameters_request(parameters, "").value().find("parameters")->as_list();
}

ServicePeer::ServicePeer(std::function<std::unique_ptr<Peer>()> make_peer, std::string node,
                         segue::ros2::InterfaceLibrary library)
    : make_peer_(std::move(make_peer)), node_(std::move(node)), library_(std::move(library)) {}

ServicePeer::~ServicePeer() {
  ends_ = true;
  if (thread_.joinable()) thread_.join();
}

void ServicePeer::serve(const std::string& name, const std::string& interface, Answer answer,
                        const ServiceHashes& hashes) {
  auto peer = make_peer_();
  peer->serve(node_ + "/" + name, interface, hashes);
  peer->announce(node_.substr(1));
  services_.push_back({std::move(peer), name, interface, std::move(answer)});
}

void ServicePeer::serve_parameters(std::function<Value::List()> parameters,
                                   const std::function<Value(const Value&)>& describe) {
  serve("list_parameters", "rcl_interfaces/srv/ListParameters", [parameters](const Value&) {
    Value::List names;
    for (const Value& parameter : parameters())
      names.push_back(*parameter.find("name"));
    return Value::map({{"result", Value::map({{"names", Value(std::move(names))}})}});
  });
  serve("get_parameters", "rcl_interfaces/srv/GetParameters", [parameters](const Value& request) {
    return of_named(request, parameters(), "values",
                    [](const Value& parameter) { return *parameter.find("value"); });
  });
  serve("describe_parameters", "rcl_interfaces/srv/DescribeParameters",
        [parameters = std::move(parameters), describe](const Value& request) {
          return of_named(request, parameters(), "descriptors", describe);
        });
}

void ServicePeer::spoil(const std::string& name, std::function<bool(Value& answer)> fault) {
  std::ranges::find(services_, name, &Service::name)->fault = std::move(fault);
}

void ServicePeer::start() {
  thread_ = std::thread([this] {
    for (; !ends_; std::this_thread::sleep_for(std::chrono::milliseconds(1)))
      answer_all();
  });
}

void ServicePeer::answer_all() {
  for (const Service& service : services_) {
    for (const Request& request : service.peer->requests()) {
      const auto asked = segue::ros2::MessageCodec::of(library_, service.interface + "_Request").value();
      auto answer = service.answer(asked.decode(request.message).value());
      if (!answer || (service.fault && !service.fault(*answer))) continue;
      // As servers of both middlewares wait for it, since a response that is sent before would be lost.
      for (int i = 0; i < 1000 && service.peer->clients() == 0; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      const auto codec = segue::ros2::MessageCodec::of(library_, service.interface + "_Response").value();
      service.peer->respond(request, codec.encode(*answer, "").value());
    }
  }
}

}  // namespace ros2::testing
