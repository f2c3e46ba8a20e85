// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../topics/topics_test_support.hpp"
#include "shown_robot.hpp"

#include <segue/control/server.hpp>
#include <segue/ros2/message_codec.hpp>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace ros2::testing {

using segue::TaskState;
using segue::type::Value;

/// A client of one service, of either middleware.
class Asker {
 public:
  Asker(std::unique_ptr<Peer> peer, const std::string& service, const std::string& interface)
      : peer_(std::move(peer)),
        request_(segue::ros2::MessageCodec::of(library_, interface + "_Request").value()),
        response_(segue::ros2::MessageCodec::of(library_, interface + "_Response").value()) {
    peer_->use(service, interface);
  }
  bool has_server() {
    return eventually([&] { return peer_->servers() == 1; });
  }
  std::int64_t send(const Value& request) {
    EXPECT_TRUE(has_server());
    return peer_->ask(request_.encode(request, "request").value());
  }
  void send_bytes(const Bytes& bytes) {
    EXPECT_TRUE(has_server());
    peer_->ask(bytes);
  }
  /// The response to that request; null where none comes.
  Value response_to(std::int64_t number) {
    std::optional<Value> found;
    EXPECT_TRUE(eventually([&] {
      for (const Response& one : peer_->responses()) {
        if (one.number == number) found = response_.decode(one.message).value();
      }
      return found.has_value();
    }));
    return found.value_or(Value());
  }
  Value ask(const Value& request) { return response_to(send(request)); }

 private:
  std::unique_ptr<Peer> peer_;
  segue::ros2::InterfaceLibrary library_;
  segue::ros2::MessageCodec request_;
  segue::ros2::MessageCodec response_;
};

/// A robot with one task, served at its socket, and the task that exposes it.
class ExposedTasks : public Topics {
 protected:
  void SetUp() override {
    ::setenv("XDG_RUNTIME_DIR", files_.folder().c_str(), 1);
    robot = std::make_unique<ShownRobot>();
    robot->add_task("drive");
    serve();
  }
  void TearDown() override {
    robot->release.open();
    exposure.reset();
    server_.reset();
  }

  void serve() {
    auto server = segue::control::Server::listen(segue::control::socket_path("fake").value(), robot.get());
    ASSERT_TRUE(server) << segue::to_string(server.error());
    server_ = std::move(*server);
  }
  void end_robot() { server_.reset(); }
  /// From now on the robot answers nobody who sets a property before it is released.
  void hold_sets() {
    robot->on_set = [this](const std::string&) {
      robot->entered.open();
      robot->release.wait_until(soon());
      return segue::Result<void>();
    };
  }

  void expose(bool writable = false, const ValueMap& more = {}) {
    ValueMap map = more;
    map.set("robot", "fake");
    map.set("namespace", "/robot");
    map.set("writable", writable);
    map.set("domain", std::int64_t{own_domain()});
    map.set("discovery", "localhost");
    exposure = std::make_unique<RunningTask>("ros2::Exposure", "exposure");
    exposure->run(map);
  }
  static std::unique_ptr<Peer> make_peer() {
    return GetParam() == Middleware::FastDds ? make_fast_peer(own_domain()) : make_cyclone_peer(own_domain());
  }
  static Asker asker(const std::string& service, const std::string& interface) {
    return {make_peer(), service, interface};
  }
  static Asker setter() { return asker("/robot/drive/set_parameters", "rcl_interfaces/srv/SetParameters"); }
  void read_rosout() const {
    segue::ros2::Quality quality;
    quality.durability = segue::ros2::Durability::TransientLocal;
    quality.depth = 100;
    peer->subscribe({.topic = "/rosout", .interface = "rcl_interfaces/msg/Log", .quality = quality});
  }
  Texts nodes() const {
    Texts names;
    for (const auto& participant : peer->others()) {
      for (const auto& node : participant.nodes)
        names.push_back(full_name(node));
    }
    std::ranges::sort(names);
    return names;
  }
  bool are_nodes(const Texts& names) const {
    return eventually([&] { return nodes() == names; });
  }
  static Value parameter(const std::string& name, int type, const char* field, const Value& value) {
    return Value::map({{"name", name}, {"value", Value::map({{"type", type}, {field, value}})}});
  }
  static Value speed(double value) { return parameter("speed", 3, "double_value", value); }
  static Value parameters(Value::List all) { return Value::map({{"parameters", Value(std::move(all))}}); }
  static Value names(Value::List all) { return Value::map({{"names", Value(std::move(all))}}); }
  static Value first_result(const Value& response) { return response.find("results")->as_list().front(); }
  TaskState state() const { return exposure->task().state(); }

  segue::testing::TemporaryFiles files_;
  std::unique_ptr<ShownRobot> robot;
  std::unique_ptr<segue::control::Server> server_;
  std::unique_ptr<RunningTask> exposure;
};

}  // namespace ros2::testing
