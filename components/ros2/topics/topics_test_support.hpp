// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../peers/peer.hpp"
#include "../peers/sanitizer_options.hpp"

#include <segue/base/policy.hpp>
#include <segue/sample_link/local.hpp>
#include <segue/sample_link/port_connection.hpp>
#include <segue/task/commit_gate.hpp>
#include <segue/task/component.hpp>
#include <segue/type/cdr_object.hpp>
#include <segue/type/describe.hpp>

#include <support/dds_domain.hpp>
#include <support/eventually.hpp>
#include <support/running_task.hpp>
#include <support/temporary_files.hpp>

#include <gmock/gmock.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

/// The struct of a user who has the message as a C++ type.
namespace std_msgs {
struct String {
  std::string data;
};
}  // namespace std_msgs
SEGUE_TYPE(std_msgs::String, data)

namespace test_msgs {
struct Label {
  std::string text;
};
}  // namespace test_msgs
SEGUE_TYPE(test_msgs::Label, text)

/// Tasks of components/ros2 and a node of ROS 2, in one process and over the loopback device.
namespace ros2::testing {

using segue::ros2::Quality;
using segue::testing::eventually;
using segue::testing::RunningTask;
using segue::testing::soon;
using segue::type::ValueMap;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using Texts = std::vector<std::string>;

inline constexpr const char* kStringHash =
    "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18";

/// Programs that run at the same time rarely share a domain, nor a topic with the same type.
inline std::uint32_t own_domain() {
  return segue::testing::dds_domain_of_process();
}

inline ValueMap properties(const std::string& interface) {
  ValueMap map;
  map.append("topic", "/chatter");
  map.append("type", interface);
  map.append("domain", std::int64_t{own_domain()});
  map.append("discovery", "localhost");
  map.append("depth", 100);
  return map;
}

inline Bytes text_message(const std::string& text) {
  const std_msgs::String sample{text};
  const auto& type = segue::type::type_info<std_msgs::String>();
  Bytes bytes(segue::type::cdr_size(type, &sample));
  segue::type::write_cdr(type, &sample, bytes);
  return bytes;
}

inline std::string text_of(const Bytes& message) {
  std_msgs::String sample;
  return segue::type::read_cdr(segue::type::type_info<std_msgs::String>(), &sample, message) ? sample.data
                                                                                             : "(corrupt)";
}

inline constexpr segue::Policy kPlenty{segue::BufferKind::Buffer, 1000, segue::Transport::Automatic, false};

/// The commit of a transition, for connections that begin with it.
class Commit {
 public:
  Commit() { gate_->arm(word_, 1); }
  segue::Result<void> connect(segue::task::OutputPortBase& from, segue::task::InputPortBase& to) {
    auto made = segue::sample_link::connect(from, to, kPlenty, gate_);
    if (!made) return made.error();
    connections_.push_back(std::move(*made));
    return {};
  }
  /// Opens the gate, and tells the ports.
  void happen() {
    word_->store(1);
    for (const auto& connection : connections_)
      connection->settle();
  }

 private:
  std::shared_ptr<segue::task::CommitWord> word_ = std::make_shared<segue::task::CommitWord>(0);
  std::shared_ptr<segue::task::CommitGate> gate_ = std::make_shared<segue::task::CommitGate>();
  std::vector<std::shared_ptr<segue::sample_link::PortConnection>> connections_;
};

/// Reads from an output, such as that of a Subscription.
class Reader final : public segue::task::Component {
 public:
  explicit Reader(RunningTask& subscription) : Reader(subscription.out()) {}
  explicit Reader(segue::task::OutputPortBase& output) {
    if (!segue::sample_link::connect(output, port_, kPlenty)) std::abort();
  }
  Reader(RunningTask& subscription, Commit& commit) {
    if (!commit.connect(subscription.out(), port_)) std::abort();
  }
  /// The texts that have arrived since the last call.
  Texts read() {
    Texts texts;
    while (auto sample = port_.take())
      texts.push_back(sample->data);
    return texts;
  }
  /// Waits for so many.
  Texts read(std::size_t count) {
    Texts all;
    static_cast<void>(eventually([&] {
      for (std::string& text : read())
        all.push_back(std::move(text));
      return all.size() >= count;
    }));
    return all;
  }

 private:
  segue::task::InputPort<std_msgs::String> port_{*this, "in"};
};

/// Writes to an input, such as that of a Publisher.
template <class Message = std_msgs::String>
class Writer final : public segue::task::Component {
 public:
  explicit Writer(RunningTask& publisher) : Writer(publisher.in()) {}
  explicit Writer(segue::task::InputPortBase& input) {
    if (!segue::sample_link::connect(port_, input, kPlenty)) std::abort();
  }
  void write(const std::string& text) { port_.write({text}); }

 private:
  segue::task::OutputPort<Message> port_{*this, "out"};
};

/// Names the tests with one or the other.
inline std::string middleware_name(const ::testing::TestParamInfo<Middleware>& given) {
  return given.param == Middleware::FastDds ? "WithFastDds" : "WithCyclone";
}

class Topics : public ::testing::TestWithParam<Middleware> {
 protected:
  /// The peer publishes; the properties of a subscription to that.
  ValueMap advertise(bool latched) {
    Quality quality;
    if (latched) quality.durability = segue::ros2::Durability::TransientLocal;
    peer->advertise({"/chatter", "std_msgs/msg/String", "", quality});
    ValueMap values = properties("std_msgs/msg/String");
    values["durability"] = latched ? "transient_local" : "volatile";
    return values;
  }

  std::unique_ptr<Peer> peer =
      GetParam() == Middleware::FastDds ? make_fast_peer(own_domain()) : make_cyclone_peer(own_domain());
};

}  // namespace ros2::testing
