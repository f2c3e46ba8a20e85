// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "peer.hpp"

#include <segue/base/mutex.hpp>
#include <segue/ros2/interface_library.hpp>
#include <segue/type/value.hpp>

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace ros2::testing {

/// The services of a node of ROS 2, answered in a thread of its own.
class ServicePeer {
 public:
  using Value = segue::type::Value;
  /// Nothing: the request is not answered.
  using Answer = std::function<std::optional<Value>(const Value& request)>;

  /// `node` ("/lidar") is announced with its services.
  ServicePeer(std::function<std::unique_ptr<Peer>()> make_peer, std::string node,
              segue::ros2::InterfaceLibrary library = segue::ros2::InterfaceLibrary());
  ~ServicePeer();
  ServicePeer(const ServicePeer&) = delete;
  ServicePeer& operator=(const ServicePeer&) = delete;

  /// Before start(): a service of the node, "get_state".
  void serve(const std::string& name, const std::string& interface, Answer answer,
             const ServiceHashes& hashes = {});
  /// Those of these parameters (rcl_interfaces/msg/Parameter) but for set_parameters_atomically; `describe`
  /// makes the ParameterDescriptor of one.
  void serve_parameters(std::function<Value::List()> parameters,
                        const std::function<Value(const Value&)>& describe);
  /// Before start(): answers of that service pass `fault`, which changes them; false: they are not sent.
  void spoil(const std::string& name, std::function<bool(Value& answer)> fault);
  void start();

 private:
  struct Service {
    std::unique_ptr<Peer> peer;
    std::string name;
    std::string interface;
    Answer answer;
    std::function<bool(Value& answer)> fault{};
  };
  void answer_all();

  const std::function<std::unique_ptr<Peer>()> make_peer_;
  const std::string node_;
  segue::ros2::InterfaceLibrary library_;
  std::vector<Service> services_;
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

/// The rcl_interfaces/msg/Parameter of each of a map.
segue::type::Value::List parameter_messages(const segue::type::Value& parameters);

}  // namespace ros2::testing
