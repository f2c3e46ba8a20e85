// SPDX-License-Identifier: Apache-2.0
#include "watched_transport.hpp"
#include "own_addresses.hpp"

#include <fastrtps/utils/IPLocator.h>

#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

namespace ros2 {
namespace {

namespace fast = eprosima::fastdds::rtps;
using eprosima::fastrtps::rtps::Locator_t;
using eprosima::fastrtps::rtps::octet;

// DDSI-RTPS 2.3, 9.4.5: a message is a header and submessages, each with an id, flags, and its length.
constexpr std::size_t kMessageHeader = 20;
constexpr std::size_t kSubmessageHeader = 4;
constexpr std::byte kAckNack{0x06};
constexpr std::byte kInfoSource{0x0c};
constexpr std::byte kInfoDestination{0x0e};
constexpr std::byte kData{0x15};
constexpr std::byte kLittleEndian{0x01};
constexpr std::byte kHasData{0x04};
constexpr std::byte kHasKey{0x08};
constexpr std::size_t kWriterId = 8;  // in the body of DATA
constexpr std::size_t kPrefix = 8;    // in the header of a message: of the participant that sends it
constexpr std::size_t kPrefixSize = 12;
constexpr std::byte kWriterOfUser{0x03};  // the kind of an entity: a writer without a key (9.3.1.2)
/// The writers that tell of participants, publishers and subscriptions.
constexpr std::array<std::uint32_t, 3> kDiscoveryWriters = {0x000100c2, 0x000003c2, 0x000004c2};

struct Submessage {
  std::size_t begin = 0;  ///< of its header
  std::size_t size = 0;   ///< of its body
};

std::uint32_t number(std::span<const std::byte> bytes) {
  std::uint32_t value = 0;
  for (const std::byte one : bytes)
    value = value << 8U | std::to_integer<std::uint32_t>(one);
  return value;
}

/// Nothing where there is none, or where it is not whole.
std::optional<Submessage> submessage_at(std::span<const std::byte> message, std::size_t begin) {
  if (begin + kSubmessageHeader > message.size()) return {};
  const bool little = (message[begin + 1] & kLittleEndian) != std::byte{0};
  const std::size_t low = std::to_integer<std::size_t>(message[begin + (little ? 2 : 3)]);
  const std::size_t high = std::to_integer<std::size_t>(message[begin + (little ? 3 : 2)]);
  const std::size_t rest = message.size() - begin - kSubmessageHeader;
  std::size_t size = high << 8U | low;
  if (size == 0 && message[begin] == kData) size = rest;  // the last one may leave it out
  if (size > rest) return {};
  return Submessage{begin, size};
}

bool is_departure(std::span<const std::byte> message, const Submessage& one) {
  const std::byte flags = message[one.begin + 1];
  if (message[one.begin] != kData || (flags & kHasKey) == std::byte{0} || one.size < kWriterId + 4)
    return false;
  const std::uint32_t writer = number(message.subspan(one.begin + kSubmessageHeader + kWriterId, 4));
  return std::ranges::find(kDiscoveryWriters, writer) != kDiscoveryWriters.end();
}

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
    if (!descriptor_.options.listens->load(std::memory_order_relaxed)) return true;
    KnownLocators known(*low_level_transport_, *begin);
    return resource->send(bytes, size, &known, end, timeout);
  }
  void receive(fast::TransportReceiverInterface* receiver, const octet* bytes, std::uint32_t size,
               const Locator_t& local, const Locator_t& remote) override {
    if (descriptor_.options.only_here && !own_addresses_.contains(address_of(remote))) return;
    const auto message = std::as_bytes(std::span(bytes, size));
    for (const Acknowledgement& one : acknowledgements_in(message))
      descriptor_.options.acknowledged(one);
    const auto changed = with_departures_as_data(message);
    const segue::Lock lock(*descriptor_.options.receiving);
    if (changed.empty()) return receiver->OnDataReceived(bytes, size, local, remote);
    receiver->OnDataReceived(reinterpret_cast<const octet*>(changed.data()), size, local, remote);
  }

 private:
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

std::vector<Acknowledgement> acknowledgements_in(std::span<const std::byte> message) {
  std::vector<Acknowledgement> found;
  Acknowledgement one;
  if (message.size() < kMessageHeader) return found;
  std::ranges::copy(message.subspan(kPrefix, kPrefixSize),
                    std::as_writable_bytes(std::span(one.reader)).begin());
  for (auto part = submessage_at(message, kMessageHeader); part;
       part = submessage_at(message, part->begin + kSubmessageHeader + part->size)) {
    const auto body = message.subspan(part->begin + kSubmessageHeader, part->size);
    const auto writer = std::as_writable_bytes(std::span(one.writer));
    // Participants of one process share messages.
    if (message[part->begin] == kInfoSource && body.size() >= kPrefix + kPrefixSize) {
      std::ranges::copy(body.subspan(kPrefix, kPrefixSize),
                        std::as_writable_bytes(std::span(one.reader)).begin());
    }
    if (message[part->begin] == kInfoDestination && body.size() >= kPrefixSize)
      std::ranges::copy(body.first(kPrefixSize), writer.begin());
    if (message[part->begin] != kAckNack || body.size() < 8 || body[7] != kWriterOfUser) continue;
    std::ranges::copy(body.first(4), std::as_writable_bytes(std::span(one.reader)).begin() + kPrefixSize);
    std::ranges::copy(body.subspan(4, 4), writer.begin() + kPrefixSize);
    found.push_back(one);
  }
  return found;
}

std::vector<std::byte> with_departures_as_data(std::span<const std::byte> message) {
  std::vector<std::byte> changed;
  for (auto one = submessage_at(message, kMessageHeader); one;
       one = submessage_at(message, one->begin + kSubmessageHeader + one->size)) {
    if (!is_departure(message, *one)) continue;
    if (changed.empty()) changed.assign(message.begin(), message.end());
    std::byte& flags = changed[one->begin + 1];
    flags = (flags & ~kHasKey) | kHasData;
  }
  return changed;
}

}  // namespace ros2
