// SPDX-License-Identifier: Apache-2.0
#include "watched_transport.hpp"

#include <segue/ros2/rtps_message.hpp>

#include <fastrtps/utils/IPLocator.h>

#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>

#include <algorithm>
#include <cstdint>
#include <span>

namespace ros2 {
namespace {

namespace fast = eprosima::fastdds::rtps;
using eprosima::fastrtps::rtps::Locator_t;
using eprosima::fastrtps::rtps::octet;

class Descriptor final : public fast::ChainingTransportDescriptor {
 public:
  Descriptor(std::shared_ptr<fast::TransportDescriptorInterface> udp, TransportOptions its)
      : ChainingTransportDescriptor(std::move(udp)), options(std::move(its)) {}
  fast::TransportInterface* create_transport() const override;

  TransportOptions options;
};

/// The addresses of a message; each is known to UDP when it is sent to. Fast DDS 2.9 leaves out that of a
/// reader which it reaches by multicast together with others (Cyclone DDS has such), but sends some messages
/// to that reader alone. Where it counts its traffic, as it does in Debian, an address that is not known ends
/// the process.
class KnownLocators final : public fast::LocatorsIterator {
 public:
  KnownLocators(fast::TransportInterface& udp, fast::LocatorsIterator& locators)
      : udp_(udp), locators_(locators) {}

  fast::LocatorsIterator& operator++() override {
    ++locators_;
    return *this;
  }
  bool operator==(const fast::LocatorsIterator& other) const override { return locators_ == other; }
  bool operator!=(const fast::LocatorsIterator& other) const override { return locators_ != other; }
  const Locator_t& operator*() const override {
    const Locator_t& locator = *locators_;
    fast::SendResourceList none;  // its sockets are open, so that it gets none
    udp_.OpenOutputChannel(none, locator);
    return locator;
  }

 private:
  fast::TransportInterface& udp_;
  fast::LocatorsIterator& locators_;
};

/// Reads along between UDP and Fast DDS.
class Transport final : public fast::ChainingTransport {
 public:
  explicit Transport(const Descriptor& descriptor) : ChainingTransport(descriptor), descriptor_(descriptor) {}

  fast::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }
  bool send(eprosima::fastrtps::rtps::SenderResource* resource, const octet* bytes, std::uint32_t size,
            fast::LocatorsIterator* begin, fast::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) override {
    const TransportOptions& options = descriptor_.options;
    if (options.alone || !options.listens->load(std::memory_order_relaxed)) return true;
    KnownLocators known(*low_level_transport_, *begin);
    return resource->send(bytes, size, &known, end, timeout);
  }
  void receive(fast::TransportReceiverInterface* receiver, const octet* bytes, std::uint32_t size,
               const Locator_t& local, const Locator_t& remote) override {
    if (!hears(address_of(remote))) return;
    const auto message = std::as_bytes(std::span(bytes, size));
    for (const segue::ros2::Acknowledgement& one : segue::ros2::acknowledgements_in(message))
      descriptor_.options.acknowledged(one);
    const auto readable = segue::ros2::readable_by_fast_dds(message);
    if (!readable.refused.empty())
      descriptor_.options.refused(segue::ros2::sender_of(message), readable.refused);
    const segue::Lock lock(*descriptor_.options.receiving);
    if (readable.bytes.empty()) return receiver->OnDataReceived(bytes, size, local, remote);
    receiver->OnDataReceived(reinterpret_cast<const octet*>(readable.bytes.data()), size, local, remote);
  }

 private:
  bool hears(const Ipv4Address& sender) {
    const TransportOptions& options = descriptor_.options;
    if (options.alone) return false;
    return !options.only_here || own_addresses_.contains(sender) ||
           std::ranges::find(options.and_from, sender) != options.and_from.end();
  }
  static Ipv4Address address_of(const Locator_t& locator) {
    Ipv4Address address{};
    std::copy_n(eprosima::fastrtps::rtps::IPLocator::getIPv4(locator), address.size(), address.begin());
    return address;
  }

  Descriptor descriptor_;
  OwnAddresses own_addresses_;
};

fast::TransportInterface* Descriptor::create_transport() const {
  return new Transport(*this);
}

}  // namespace

std::shared_ptr<fast::TransportDescriptorInterface> watched_transport(
    std::shared_ptr<fast::TransportDescriptorInterface> udp, TransportOptions options) {
  return std::make_shared<Descriptor>(std::move(udp), std::move(options));
}

}  // namespace ros2
