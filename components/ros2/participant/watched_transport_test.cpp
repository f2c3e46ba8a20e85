// SPDX-License-Identifier: Apache-2.0
#include "watched_transport.hpp"
#include "own_addresses.hpp"

#include <segue/base/descriptor.hpp>

#include <gtest/gtest.h>

#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/TransportInterface.h>
#include <fastdds/rtps/transport/TransportReceiverInterface.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastdds/rtps/common/LocatorList.hpp>

#include <netinet/in.h>
#include <sys/socket.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

namespace ros2 {
namespace {

using Bytes = std::vector<std::byte>;

/// The header of an RTPS message of Cyclone DDS.
Bytes header() {
  Bytes bytes;
  for (const int one : {0x52, 0x54, 0x50, 0x53, 2, 1, 1, 0x10})  // "RTPS"
    bytes.push_back(static_cast<std::byte>(one));
  bytes.resize(20);
  return bytes;
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

using eprosima::fastrtps::rtps::Locator_t;
using eprosima::fastrtps::rtps::octet;

/// Counts the messages that reach Fast DDS.
class Receiver final : public eprosima::fastdds::rtps::TransportReceiverInterface {
 public:
  void OnDataReceived(const octet*, std::uint32_t, const Locator_t&, const Locator_t&) override { ++count; }
  int count = 0;
};

/// A socket on the loopback device.
class OtherSocket {
 public:
  OtherSocket() {
    address_.sin_family = AF_INET;
    address_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address_;
    EXPECT_EQ(::bind(socket_.get(), reinterpret_cast<sockaddr*>(&address_), size), 0);
    EXPECT_EQ(::getsockname(socket_.get(), reinterpret_cast<sockaddr*>(&address_), &size), 0);
  }
  std::uint16_t port() const { return ntohs(address_.sin_port); }
  /// The size of the next message.
  std::size_t receive() {
    Bytes received(100);
    return static_cast<std::size_t>(::recv(socket_.get(), received.data(), received.size(), 0));
  }

 private:
  const segue::Descriptor socket_{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
  sockaddr_in address_{};
};

/// A transport on the loopback device with a channel to one port.
class WatchedTransport : public ::testing::Test {
 protected:
  void SetUp() override { open({}); }
  /// Anew, as `wanted` says who is heard.
  void open(TransportOptions wanted) {
    resources_.clear();
    wanted.acknowledged = [](const segue::ros2::Acknowledgement&) {};
    wanted.refused = [](const segue::ros2::Gid&, std::string_view) {};
    wanted.listens = listens_;
    auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList = {"127.0.0.1"};
    const auto descriptor = watched_transport(udp, std::move(wanted));
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

  /// Whether a message from there reaches Fast DDS.
  bool hears(const Ipv4Address& sender) {
    Receiver receiver;
    Locator_t remote;
    eprosima::fastrtps::rtps::IPLocator::setIPv4(remote, sender[0], sender[1], sender[2], sender[3]);
    const Bytes message = header();
    dynamic_cast<eprosima::fastdds::rtps::ChainingTransport&>(*transport_)
        .receive(&receiver, reinterpret_cast<const octet*>(message.data()),
                 static_cast<std::uint32_t>(message.size()), Locator_t(), remote);
    return receiver.count == 1;
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
  OtherSocket other;
  *listens_ = false;
  send(header(), other.port());
  *listens_ = true;
  Bytes second = header();
  second.push_back(std::byte{7});
  EXPECT_TRUE(send(second, other.port()));
  EXPECT_EQ(other.receive(), second.size()) << "the first that arrives is the second";
}

constexpr Ipv4Address kHere{127, 0, 0, 1};
constexpr Ipv4Address kElsewhere{203, 0, 113, 1};
constexpr Ipv4Address kPeer{203, 0, 113, 2};

TEST_F(WatchedTransport, HearsAllUnlessToldOtherwise) {
  for (const Ipv4Address& sender : {kHere, kElsewhere, kPeer})
    EXPECT_TRUE(hears(sender));
}

TEST_F(WatchedTransport, HearsThisComputerAndPeersWhereItIsToldTo) {
  open({.only_here = true, .and_from = {kPeer}});
  EXPECT_TRUE(hears(kHere));
  EXPECT_FALSE(hears(kElsewhere));
  EXPECT_TRUE(hears(kPeer));
}

TEST_F(WatchedTransport, NeitherHearsNorSendsWhereItIsAlone) {
  open({.and_from = {kPeer}, .alone = true});
  for (const Ipv4Address& sender : {kHere, kElsewhere, kPeer})
    EXPECT_FALSE(hears(sender));
  OtherSocket other;
  send(header(), other.port());
  open({});
  Bytes second = header();
  second.push_back(std::byte{7});
  EXPECT_TRUE(send(second, other.port()));
  EXPECT_EQ(other.receive(), second.size()) << "the first that arrives is the second";
}

}  // namespace
}  // namespace ros2
