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

#include <atomic>
#include <cstdint>
#include <memory>
#include <string_view>
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

/// A transport on the loopback device with a channel to one port.
class WatchedTransport : public ::testing::Test {
 protected:
  void SetUp() override {
    auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList = {"127.0.0.1"};
    const auto descriptor =
        watched_transport(udp, {[](const segue::ros2::Acknowledgement&) {},
                                [](const segue::ros2::Gid&, std::string_view) {}, false, listens_});
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
