// SPDX-License-Identifier: Apache-2.0
#include "watched_transport.hpp"
#include "own_addresses.hpp"

#include <segue/base/descriptor.hpp>

#include <gtest/gtest.h>

#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/TransportInterface.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastdds/rtps/common/LocatorList.hpp>

#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <random>

namespace ros2 {
namespace {

using Bytes = std::vector<std::byte>;

void append(Bytes& bytes, std::initializer_list<int> more) {
  for (const int one : more)
    bytes.push_back(static_cast<std::byte>(one));
}

/// The header of an RTPS message of Cyclone DDS.
Bytes header() {
  Bytes bytes;
  append(bytes, {'R', 'T', 'P', 'S', 2, 1, 1, 0x10});
  bytes.resize(20);
  return bytes;
}

/// DATA without inline QoS, of a writer of discovery or another one; its payload is a key or a sample.
void append_data(Bytes& bytes, std::initializer_list<int> writer, bool is_key, bool little = true) {
  append(bytes, {0x15, (is_key ? 0x08 : 0x04) | (little ? 0x01 : 0x00)});
  append(bytes, little ? std::initializer_list<int>{48, 0} : std::initializer_list<int>{0, 48});
  append(bytes, {0, 0, 16, 0, 0, 0, 0, 0});
  append(bytes, writer);
  bytes.resize(bytes.size() + 36);
}

constexpr std::size_t kFlags = 21;  // of the first submessage

TEST(Departures, KeysOfDiscoveryAreMarkedAsData) {
  for (const bool little : {true, false}) {
    for (const auto writer :
         {std::initializer_list<int>{0, 0, 0x03, 0xc2}, {0, 0, 0x04, 0xc2}, {0, 1, 0, 0xc2}}) {
      Bytes message = header();
      append_data(message, writer, true, little);
      Bytes expected = message;
      expected[kFlags] = std::byte{static_cast<unsigned char>(little ? 0x05 : 0x04)};
      EXPECT_EQ(with_departures_as_data(message), expected);
    }
  }
}

TEST(Departures, AreFoundAmongOtherSubmessages) {
  Bytes message = header();
  append(message, {0x09, 0x01, 8, 0, 1, 2, 3, 4, 5, 6, 7, 8});  // INFO_TS
  append_data(message, {0, 0, 0x03, 0xc2}, false);
  const std::size_t second = message.size();
  append_data(message, {0, 0, 0x03, 0xc2}, true);
  append_data(message, {0, 0, 0x12, 0x03}, true);  // the key of a sample of the user
  Bytes expected = message;
  expected[second + 1] = std::byte{0x05};
  EXPECT_EQ(with_departures_as_data(message), expected);
}

TEST(Departures, OtherMessagesAreLeftAlone) {
  Bytes message = header();
  EXPECT_TRUE(with_departures_as_data(message).empty());
  append_data(message, {0, 0, 0x03, 0xc2}, false);
  append_data(message, {0, 0, 0x12, 0x03}, true);
  EXPECT_TRUE(with_departures_as_data(message).empty());
}

/// An acknowledgement, of a reader and for a writer of these kinds.
void append_acknowledgement(Bytes& bytes, int reader, int writer) {
  append(bytes, {0x06, 0x01, 24, 0, 0, 0, 9, reader, 0, 0, 8, writer});
  bytes.resize(bytes.size() + 16);
}

TEST(Acknowledgements, HaveTheReaderAndTheWriter) {
  Bytes message = header();
  for (std::size_t i = 8; i < 20; ++i)
    message[i] = std::byte{0xaa};
  append(message, {0x0e, 0x01, 12, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12});  // INFO_DST
  append_acknowledgement(message, 0x04, 0x03);
  append_acknowledgement(message, 0xc7, 0xc2);                      // of discovery
  append(message, {0x0c, 0x01, 20, 0, 0, 0, 0, 0, 2, 1, 1, 0x10});  // INFO_SRC, of another participant
  message.resize(message.size() + 12, std::byte{0xbb});
  append_acknowledgement(message, 0x04, 0x03);
  const auto found = acknowledgements_in(message);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found.back().reader[0], 0xbb);
  segue::ros2::Gid reader;
  reader.fill(0xaa);
  std::ranges::copy(std::array<std::uint8_t, 4>{0, 0, 9, 4}, reader.begin() + 12);
  EXPECT_EQ(found.front().reader, reader);
  EXPECT_EQ(found.front().writer, (segue::ros2::Gid{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 0, 0, 8, 3}));
}

TEST(Departures, HostileBytesDoNoHarm) {
  Bytes message = header();
  append_data(message, {0, 0, 0x03, 0xc2}, true);
  for (std::size_t size = 0; size < message.size(); ++size)
    EXPECT_TRUE(with_departures_as_data(std::span(message).first(size)).empty()) << size;
  std::mt19937 random(1);
  for (int i = 0; i < 20'000; ++i) {
    Bytes noise = header();
    for (std::uint32_t left = random() % 64; left > 0; --left)
      noise.push_back(
          static_cast<std::byte>(random() % 4 == 0 ? (random() % 2 == 0 ? 0x15 : 0x06) : random() % 256));
    const auto changed = with_departures_as_data(noise);
    EXPECT_TRUE(changed.empty() || changed.size() == noise.size());
    EXPECT_LE(acknowledgements_in(noise).size(), noise.size());
  }
}

/// An address on this computer.
eprosima::fastdds::rtps::LocatorList locator_of_port(std::uint32_t port) {
  eprosima::fastrtps::rtps::Locator_t locator;
  locator.kind = LOCATOR_KIND_UDPv4;
  locator.port = port;
  eprosima::fastrtps::rtps::IPLocator::setIPv4(locator, 127, 0, 0, 1);
  eprosima::fastdds::rtps::LocatorList list;
  list.push_back(locator);
  return list;
}

TEST(OwnAddresses, AreThoseOfThisComputer) {
  OwnAddresses own;
  EXPECT_TRUE(own.contains({127, 0, 0, 1}));
  EXPECT_FALSE(own.contains({203, 0, 113, 1})) << "for documentation only (RFC 5737)";
}

/// A transport on the loopback device with a channel to one port.
class WatchedTransport : public ::testing::Test {
 protected:
  void SetUp() override {
    auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList = {"127.0.0.1"};
    const auto descriptor = watched_transport(udp, {[](const Acknowledgement&) {}, false, listens_});
    transport_.reset(descriptor->create_transport());
    ASSERT_TRUE(transport_->init());
    const auto told = locator_of_port(7400);
    ASSERT_TRUE(transport_->OpenOutputChannel(resources_, *told.begin()));
    ASSERT_EQ(resources_.size(), 1U);
  }
  bool send(const Bytes& message, std::uint16_t port) {
    const auto other = locator_of_port(port);
    eprosima::fastdds::rtps::Locators begin(other.begin());
    eprosima::fastdds::rtps::Locators end(other.end());
    const bool sent =
        resources_.front()->send(reinterpret_cast<const eprosima::fastrtps::rtps::octet*>(message.data()),
                                 static_cast<std::uint32_t>(message.size()), &begin, &end,
                                 std::chrono::steady_clock::now() + std::chrono::seconds(1));
    const eprosima::fastdds::rtps::LocatorsIterator& reached = begin;
    const eprosima::fastdds::rtps::LocatorsIterator& all = end;
    return sent && reached == all;
  }

  std::shared_ptr<std::atomic<bool>> listens_ = std::make_shared<std::atomic<bool>>(true);

 private:
  std::unique_ptr<eprosima::fastdds::rtps::TransportInterface> transport_;
  eprosima::fastdds::rtps::SendResourceList resources_;
};

TEST_F(WatchedTransport, SendsToAddressesThatItWasNotToldOf) {
  EXPECT_TRUE(send(header(), 9)) << "where nobody listens";
}

TEST_F(WatchedTransport, SendsNothingBeforeItListens) {
  const segue::Descriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ASSERT_EQ(::bind(socket.get(), reinterpret_cast<sockaddr*>(&address), size), 0);
  ASSERT_EQ(::getsockname(socket.get(), reinterpret_cast<sockaddr*>(&address), &size), 0);
  *listens_ = false;
  send(header(), ntohs(address.sin_port));
  *listens_ = true;
  Bytes second = header();
  second.push_back(std::byte{7});
  EXPECT_TRUE(send(second, ntohs(address.sin_port)));
  Bytes received(100);
  const auto count = ::recv(socket.get(), received.data(), received.size(), 0);
  EXPECT_EQ(static_cast<std::size_t>(count), second.size()) << "the first that arrives is the second";
}

}  // namespace
}  // namespace ros2
