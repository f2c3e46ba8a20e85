// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../topics/topics_test_support.hpp"
#include "participant.hpp"

#include <support/logged_lines.hpp>

#include <chrono>
#include <memory>
#include <string>
#include <thread>

namespace ros2::testing {

/// A task that listens to a node, beside a hostile participant.
class HostileParticipants : public Topics {
 protected:
  HostileParticipants() {
    talker->advertise({"/chatter", "std_msgs/msg/String", kStringHash, {}});
    talker->announce("talker");
    subscription.run(properties("std_msgs/msg/String"));
    reader = std::make_unique<Reader>(subscription);
    participant = Participant::join({own_domain(), Range::Localhost}).value();
  }
  ~HostileParticipants() override { reader.reset(); }

  [[nodiscard]] segue::ros2::Gid participant_of(const std::string& node) const {
    for (const auto& seen : participant->graph().snapshot().participants) {
      for (const auto& each : seen.entities.nodes) {
        if (full_name(each) == node) return seen.entities.participant;
      }
    }
    return {};
  }
  /// Whether samples of the node arrive.
  [[nodiscard]] bool listens() {
    static_cast<void>(reader->read());
    return eventually([&] {
      talker->publish(text_message("hello"));
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      return !reader->read().empty();
    });
  }

  std::unique_ptr<Peer>& hostile = peer;
  std::unique_ptr<Peer> talker = make_fast_peer(own_domain());
  segue::testing::LoggedLines lines;
  RunningTask subscription{"ros2::Subscription", "listener"};
  std::unique_ptr<Reader> reader;
  std::shared_ptr<Participant> participant;
};

}  // namespace ros2::testing
