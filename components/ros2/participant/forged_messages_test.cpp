// SPDX-License-Identifier: Apache-2.0
// Messages of RTPS that no DDS sends (DDSI-RTPS 2.3, 9.4).
#include "hostile_participants_test_support.hpp"

#include <segue/base/descriptor.hpp>

#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <random>
#include <span>

namespace ros2::testing {
namespace {

using segue::ros2::Gid;

constexpr int kHeartbeat = 0x07;
constexpr int kGap = 0x08;
constexpr int kData = 0x15;
constexpr int kDataFrag = 0x16;
constexpr int kLittleEndian = 1;
constexpr int kHasData = 4;

Bytes bytes_of(std::initializer_list<int> values) {
  Bytes bytes;
  for (const int one : values)
    bytes.push_back(static_cast<std::byte>(one));
  return bytes;
}

void append(Bytes& bytes, std::span<const std::byte> more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

/// The header of a message of the participant whose endpoint that is.
Bytes header(const Gid& sender) {
  Bytes bytes = bytes_of({'R', 'T', 'P', 'S', 2, 3, 1, 15});
  append(bytes, std::as_bytes(std::span(sender).first(12)));
  return bytes;
}

/// To the ports of participant 4 of its domain, which is that of tasks (DDSI-RTPS 2.3, 9.6.1.1).
void send(const Bytes& bytes) {
  static const segue::Descriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
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

/// They look as if the node, or a participant that is beside it, had sent them.
class ForgedMessages : public HostileParticipants {
 protected:
  void SetUp() override {
    ASSERT_TRUE(listens());
    const auto writers = participant->graph().endpoints("rt/chatter", true);
    ASSERT_EQ(writers.size(), 1U);
    writer = writers.front().gid;
  }

  /// A message with one submessage of the node's publisher: its identifier is between two parts of the body,
  /// and zeros are behind them. It says that its body has `length` bytes (0: up to the end of the message).
  void forge(int id, int flags, const Bytes& before, const Bytes& behind, std::size_t zeros = 0,
             int length = 0) const {
    Bytes bytes = header(writer);
    append(bytes, bytes_of({id, flags | kLittleEndian, length, 0}));
    append(bytes, before);
    append(bytes, std::as_bytes(std::span(writer).last(4)));
    append(bytes, behind);
    bytes.resize(bytes.size() + zeros);
    send(bytes);
  }

  Gid writer{};
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
  // All of 64 MB at once; 4 GB; smaller than what Fast DDS keeps in them; before the first.
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
  EXPECT_TRUE(lines.has({"participant", "not taken: it has fragments that its sample does not have"}));
  EXPECT_TRUE(listens());
}

TEST_P(ForgedMessages, OfGapsWithoutEndDoNoHarm) {
  forge(kGap, 0, bytes_of({0, 0, 0, 0}),
        bytes_of({0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0x10, 0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_TRUE(lines.has({"participant", "not taken: it has a gap of too many samples"}));
  EXPECT_TRUE(listens());
}

TEST_P(ForgedMessages, OfHeartbeatsThatHaveSkippedAlmostAllDoNoHarm) {
  forge(kHeartbeat, 0, bytes_of({0, 0, 0, 0}),
        bytes_of({0, 0, 0, 0x10, 0, 0, 0, 0, 0, 0, 0, 0x10, 1, 0, 0, 0, 0xff, 0xff, 0, 0}));
  EXPECT_TRUE(
      lines.has({"participant", "not taken: it is of a publisher that says that it has sent too many"}));
  EXPECT_TRUE(listens());
}

/// Makes submessages of each kind, with numbers that are at the borders of what they may be.
class RandomMessages {
 public:
  RandomMessages(const Gid& sender, std::uint32_t seed) : sender_(sender), random_(seed) {}

  Bytes next() {
    Bytes message = header(sender_);
    for (std::uint32_t left = 1 + below(4); left > 0; --left)
      append_submessage(message);
    return message;
  }

 private:
  std::uint32_t below(std::uint32_t limit) { return static_cast<std::uint32_t>(random_() % limit); }
  template <class Value, std::size_t kSize>
  Value one_of(const std::array<Value, kSize>& values) {
    return values[below(kSize)];
  }
  void append_number(Bytes& bytes) {
    constexpr std::array<std::uint32_t, 12> kNumbers = {
        0, 1, 2, 3, 4, 8, 256, 0x10000, 0x10001, 0x7fffffff, 0x80000000, 0xffffffff};
    const std::uint32_t number = one_of(kNumbers);
    for (int shift = 0; shift < 32; shift += 8)
      bytes.push_back(static_cast<std::byte>(number >> shift));
  }
  /// Of discovery, of liveliness, and of the sender's publisher.
  void append_writer(Bytes& bytes) {
    const std::array<Bytes, 4> builtin = {bytes_of({0, 1, 0, 0xc2}), bytes_of({0, 0, 3, 0xc2}),
                                          bytes_of({0, 0, 4, 0xc2}), bytes_of({0, 2, 0, 0xc2})};
    append(bytes, below(2) == 0 ? std::as_bytes(std::span(sender_).last(4)) : std::span(builtin[below(4)]));
  }
  void append_submessage(Bytes& message) {
    constexpr std::array<int, 12> kKinds = {0x01, 0x06, kHeartbeat, kGap,  0x09,      0x0c,
                                            0x0e, 0x12, 0x13,       kData, kDataFrag, 0x30};
    const int kind = one_of(kKinds);
    Bytes body;
    if (kind == kData || kind == kDataFrag) {
      const int usual = kind == kData ? 16 : 28;
      append(body, bytes_of({0, 0, below(8) == 0 ? static_cast<int>(below(256)) : usual, 0}));
    }
    append(body, bytes_of({0, 0, 0, 0}));
    append_writer(body);
    for (std::uint32_t left = below(14); left > 0; --left)
      append_number(body);
    const auto said = below(8) == 0 ? below(80) : static_cast<std::uint32_t>(body.size());
    append(message, bytes_of({kind, static_cast<int>(below(16)) | kLittleEndian, static_cast<int>(said), 0}));
    append(message, body);
  }

  const Gid sender_;
  std::mt19937 random_;
};

TEST_P(ForgedMessages, ThatAreRandomDoNoHarm) {
  hostile->advertise({"/chatter", "std_msgs/msg/String", kStringHash, {}});
  const auto other = [&] {
    const auto writers = participant->graph().endpoints("rt/chatter", true);
    const auto found = std::ranges::find_if(writers, [&](const auto& one) { return one.gid != writer; });
    return found == writers.end() ? Gid{} : found->gid;
  };
  ASSERT_TRUE(eventually([&] { return other() != Gid{}; }));
  RandomMessages messages(other(), 3);
  for (int i = 0; i < 5'000; ++i)
    send(messages.next());
  EXPECT_TRUE(listens());
}

INSTANTIATE_TEST_SUITE_P(, ForgedMessages, ::testing::Values(Middleware::FastDds), middleware_name);

}  // namespace
}  // namespace ros2::testing
