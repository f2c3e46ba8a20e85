// SPDX-License-Identifier: Apache-2.0
// Participants that lie about nodes, and that bring more than a robot has.
#include "participant.hpp"
#include "topics_test_support.hpp"

#include <segue/base/descriptor.hpp>

#include <support/logged_lines.hpp>

#include <netinet/in.h>
#include <sys/socket.h>

#include <initializer_list>
#include <random>
#include <span>
#include <thread>

namespace ros2::testing {
namespace {

using segue::ros2::Gid;
using segue::ros2::ParticipantEntities;
using segue::testing::LoggedLines;

/// A task that listens to a node, beside a hostile participant.
class HostileParticipants : public Topics {
 protected:
  HostileParticipants() {
    talker->advertise({"/chatter", "std_msgs/msg/String", kStringHash, {}});
    talker->announce("talker");
    subscription.run(properties("std_msgs/msg/String"));
    reader = std::make_unique<Reader>(subscription);
    participant = Participant::join({own_domain(), true}).value();
  }
  ~HostileParticipants() override { reader.reset(); }

  [[nodiscard]] Gid participant_of(const std::string& node) const {
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
  LoggedLines lines;
  RunningTask subscription{"ros2::Subscription", "listener"};
  std::unique_ptr<Reader> reader;
  std::shared_ptr<Participant> participant;
};

TEST_P(HostileParticipants, SayNothingAboutOthers) {
  ASSERT_TRUE(eventually([&] { return participant_of("/talker") != Gid{}; }));
  const Gid other = participant_of("/talker");
  hostile->announce("hostile");
  ASSERT_TRUE(eventually([&] { return participant_of("/hostile") != Gid{}; }));
  hostile->say(segue::ros2::encode({other, {{"/", "thief", {}, {}}}}));
  EXPECT_TRUE(lines.has({"participant", "is not taken: it speaks for another participant"}));
  hostile->announce("hostile_too");
  ASSERT_TRUE(eventually([&] { return participant_of("/hostile_too") != Gid{}; }));
  EXPECT_EQ(participant_of("/talker"), other);
  EXPECT_EQ(participant_of("/thief"), Gid{});
  EXPECT_TRUE(listens());
}

TEST_P(HostileParticipants, WhoseBytesAreNoMessagesAreNotHeard) {
  std::mt19937 random(7);
  const Bytes good = segue::ros2::encode({{}, {{"/", "one", {Gid{}}, {Gid{}, Gid{}}}}});
  for (std::size_t i = 0; i < 300; ++i) {
    Bytes bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(5 + random() % (good.size() - 5)));
    for (std::size_t k = 4 + i % 4; k < bytes.size(); k += 1 + i % 7)
      bytes[k] = static_cast<std::byte>(random());
    hostile->say(bytes);
  }
  hostile->say(segue::ros2::encode({{}, {{"/", "\033[2J", {}, {}}}}));
  hostile->announce("calm");
  EXPECT_TRUE(eventually([&] { return participant_of("/calm") != Gid{}; }));
  for (const auto& seen : participant->graph().snapshot().participants) {
    for (const auto& node : seen.entities.nodes)
      EXPECT_THAT(full_name(node), ::testing::AnyOf("/talker", "/calm", "/listener"));
  }
  EXPECT_TRUE(listens());
}

TEST_P(HostileParticipants, WithAThousandWrongEndpointsStopNothing) {
  constexpr std::size_t kMany = 1000;
  hostile->advertise({"/chatter", "std_msgs/msg/Int32", "", {}});
  hostile->advertise_more({"/chatter", "std_msgs/msg/Int32", "", {}}, kMany);
  hostile->announce("hostile");
  const std::string topic = "rt/chatter";
  EXPECT_TRUE(eventually([&] { return participant->graph().endpoints(topic, true).size() == kMany + 2; }));
  EXPECT_TRUE(lines.has({"node /hostile publishes /chatter, but its type is std_msgs/msg/Int32"}));
  EXPECT_EQ(subscription.count("mismatched"), segue::ros2::NodeGraph::kMostMismatches);
  EXPECT_TRUE(listens());
  EXPECT_LT(lines.count(), 100U) << "the log stays readable";
  hostile.reset();
  EXPECT_TRUE(eventually([&] { return participant->graph().endpoints(topic, true).size() == 1; }));
  EXPECT_TRUE(eventually([&] { return subscription.count("mismatched") == 0; }));
  EXPECT_TRUE(listens());
}

/// Messages of RTPS that look as if the node had sent them (DDSI-RTPS 2.3, 9.4).
class ForgedMessages : public HostileParticipants {
 protected:
  void SetUp() override {
    ASSERT_TRUE(listens());
    const auto writers = participant->graph().endpoints("rt/chatter", true);
    ASSERT_EQ(writers.size(), 1U);
    writer_ = writers.front().gid;
  }

  /// Sends a message with one submessage: the writer's identifier is between two parts of its body, and zeros
  /// are behind it. It says that its body has `length` bytes (0: up to the end of the message).
  void forge(int id, int flags, const Bytes& before, const Bytes& behind, std::size_t zeros = 0,
             int length = 0) {
    Bytes bytes = bytes_of({'R', 'T', 'P', 'S', 2, 3, 1, 15});
    append(bytes, std::as_bytes(std::span(writer_).first(12)));
    append(bytes, bytes_of({id, flags | kLittleEndian, length, 0}));
    append(bytes, before);
    append(bytes, std::as_bytes(std::span(writer_).last(4)));
    append(bytes, behind);
    bytes.resize(bytes.size() + zeros);
    send(bytes);
  }

  static Bytes bytes_of(std::initializer_list<int> values) {
    Bytes bytes;
    for (const int one : values)
      bytes.push_back(static_cast<std::byte>(one));
    return bytes;
  }

  static constexpr int kData = 0x15;
  static constexpr int kDataFrag = 0x16;
  static constexpr int kGap = 0x08;
  static constexpr int kLittleEndian = 1;
  static constexpr int kHasData = 4;

 private:
  static void append(Bytes& bytes, std::span<const std::byte> more) {
    bytes.insert(bytes.end(), more.begin(), more.end());
  }

  /// To the ports of participant 4 of its domain, which is that of tasks (DDSI-RTPS 2.3, 9.6.1.1).
  static void send(const Bytes& bytes) {
    const segue::Descriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    for (const unsigned kind : {10U, 11U}) {
      sockaddr_in address{};
      address.sin_family = AF_INET;
      address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      address.sin_port = htons(static_cast<std::uint16_t>(7400 + 250 * own_domain() + kind + 2 * 4));
      ASSERT_EQ(::sendto(socket.get(), bytes.data(), bytes.size(), 0,
                         reinterpret_cast<const sockaddr*>(&address), sizeof address),
                static_cast<ssize_t>(bytes.size()));
    }
  }

  Gid writer_{};
};

TEST_P(ForgedMessages, OfDataThatBeginsBehindItsEndDoNoHarm) {
  for (const int to_qos : {24, 2000, 0xfff0})
    forge(kData, kHasData, bytes_of({0, 0, to_qos & 0xff, to_qos >> 8, 0, 0, 0, 0}),
          bytes_of({0, 0, 0, 0, 0, 0, 1, 0}), 3000, 24);
  EXPECT_TRUE(
      lines.has({"participant", "a part of a message is not taken: it has data that begins behind its end"}));
  EXPECT_TRUE(listens());
}

TEST_P(ForgedMessages, OfFragmentsThatAreNotThereDoNoHarm) {
  struct Fragments {
    int first, count, size;
    int sample;  // in units of 65536 bytes
  };
  // All of 64 MB at once; 4 GB; fragments that are smaller than what Fast DDS keeps in them; before the
  // first.
  for (const auto& [first, count, size, sample] :
       {Fragments{1, 0x401, 0xffff, 0x400}, {1, 1, 1024, 0xffff}, {1, 1, 1, 0x100}, {0, 1, 1024, 2}}) {
    forge(kDataFrag, 0, bytes_of({0, 0, 28, 0, 0, 0, 0, 0}),
          bytes_of({0,
                    0,
                    0,
                    0,
                    0,
                    0,
                    1,
                    0,
                    first,
                    0,
                    0,
                    0,
                    count & 0xff,
                    count >> 8,
                    size & 0xff,
                    size >> 8,
                    0,
                    0,
                    sample & 0xff,
                    sample >> 8}),
          1100);
  }
  EXPECT_TRUE(lines.has(
      {"participant", "a part of a message is not taken: it has fragments that its sample does not have"}));
  EXPECT_TRUE(listens());
}

TEST_P(ForgedMessages, OfGapsWithoutEndDoNoHarm) {
  forge(kGap, 0, bytes_of({0, 0, 0, 0}),
        bytes_of({0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0x10, 0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_TRUE(
      lines.has({"participant", "a part of a message is not taken: it has a gap of too many samples"}));
  EXPECT_TRUE(listens());
}

INSTANTIATE_TEST_SUITE_P(, HostileParticipants, ::testing::Values(Middleware::FastDds, Middleware::Cyclone),
                         middleware_name);
INSTANTIATE_TEST_SUITE_P(, ForgedMessages, ::testing::Values(Middleware::FastDds), middleware_name);

}  // namespace
}  // namespace ros2::testing
