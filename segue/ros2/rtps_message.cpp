// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/rtps_message.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace segue::ros2 {
namespace {

// A message is a header and submessages, each with an id, flags, and its length.
constexpr std::size_t kMessageHeader = 20;
constexpr std::size_t kSubmessageHeader = 4;
constexpr std::byte kPad{0x01};
constexpr std::byte kAckNack{0x06};
constexpr std::byte kHeartbeat{0x07};
constexpr std::byte kGap{0x08};
constexpr std::byte kInfoTime{0x09};
constexpr std::byte kInfoSource{0x0c};
constexpr std::byte kInfoDestination{0x0e};
constexpr std::byte kData{0x15};
constexpr std::byte kDataFrag{0x16};
constexpr std::byte kNackFrag{0x12};
constexpr std::byte kHeartbeatFrag{0x13};
constexpr std::byte kOfVendor{0x80};  // ids from here on are skipped by whoever does not know the vendor's
constexpr std::byte kLittleEndian{0x01};
constexpr std::byte kHasQos{0x02};
constexpr std::byte kHasData{0x04};
constexpr std::byte kHasKey{0x08};
constexpr std::size_t kWriterId = 8;  // in the body of DATA and DATA_FRAG
constexpr std::size_t kPrefix = 8;    // in the header of a message: of the participant that sends it
constexpr std::size_t kPrefixSize = 12;
constexpr std::byte kWriterOfUser{0x03};  // the kind of an entity: a writer without a key (9.3.1.2)
constexpr std::byte kBuiltIn{0xc0};       // of kinds of entities that every participant has
constexpr std::uint64_t kEndOfSequences = std::uint64_t{1} << 62U;
/// The writers that tell of participants, publishers and subscriptions.
constexpr std::array<std::uint32_t, 3> kDiscoveryWriters = {0x000100c2, 0x000003c2, 0x000004c2};

struct Submessage {
  std::byte id{};
  std::byte flags{};
  std::size_t begin = 0;  ///< of its header in the message
  std::span<const std::byte> body{};

  [[nodiscard]] bool has(std::byte flag) const { return (flags & flag) != std::byte{0}; }
  /// Each begins at a multiple of 4.
  [[nodiscard]] std::size_t end() const { return begin + kSubmessageHeader + (body.size() + 3) / 4 * 4; }
  /// A number in its own byte order; its bytes must be there.
  template <class Number>
  [[nodiscard]] Number number(std::size_t at) const {
    Number value = 0;
    for (std::size_t i = 0; i < sizeof(Number); ++i) {
      const std::size_t place = has(kLittleEndian) ? at + sizeof(Number) - 1 - i : at + i;
      value = static_cast<Number>(std::uint64_t{value} << 8U | std::to_integer<std::uint64_t>(body[place]));
    }
    return value;
  }
  /// A sequence number: its upper half is first in either byte order (9.3.2).
  [[nodiscard]] std::uint64_t sequence(std::size_t at) const {
    return std::uint64_t{number<std::uint32_t>(at)} << 32U | number<std::uint32_t>(at + 4);
  }
  [[nodiscard]] bool of_discovery() const { return (body[kWriterId + 3] & kBuiltIn) == kBuiltIn; }
};

/// Nothing where there is none, or where it is not whole.
std::optional<Submessage> submessage_at(std::span<const std::byte> message, std::size_t begin) {
  if (begin + kSubmessageHeader > message.size()) return {};
  const auto rest = message.subspan(begin + kSubmessageHeader);
  Submessage one{message[begin], message[begin + 1], begin, message.subspan(begin + 2, 2)};
  std::size_t size = one.number<std::uint16_t>(0);
  // The last one may leave out its length (9.4.5.1.3).
  if (size == 0 && one.id != kPad && one.id != kInfoTime) size = rest.size();
  if (size > rest.size()) return {};
  one.body = rest.first(size);
  return one;
}

/// Calls `look` with each whole submessage.
template <class Look>
void for_each_submessage(std::span<const std::byte> message, const Look& look) {
  for (auto one = submessage_at(message, kMessageHeader); one; one = submessage_at(message, one->end()))
    look(*one);
}

bool is_departure(const Submessage& one) {
  if (one.id != kData || !one.has(kHasKey) || one.body.size() < kWriterId + 4) return false;
  std::uint32_t writer = 0;  // an octet array, the same in either byte order
  for (const std::byte part : one.body.subspan(kWriterId, 4))
    writer = writer << 8U | std::to_integer<std::uint32_t>(part);
  return std::ranges::find(kDiscoveryWriters, writer) != kDiscoveryWriters.end();
}

/// Where the payload of DATA and DATA_FRAG begins, behind the inline QoS, a list of parameters; nothing where
/// that is not within the body. `fixed` is the size of all before the inline QoS.
std::optional<std::size_t> payload_of(const Submessage& one, std::size_t fixed) {
  constexpr std::size_t kToQos = 2;           // a number: the distance from behind it to the inline QoS
  constexpr std::uint16_t kMost = INT16_MAX;  // Fast DDS takes it as signed
  constexpr std::uint16_t kSentinel = 1;      // the parameter that ends a list
  if (one.body.size() < fixed || one.number<std::uint16_t>(kToQos) > kMost) return {};
  std::size_t at = kToQos + 2 + one.number<std::uint16_t>(kToQos);
  if (at < fixed) return {};
  for (bool more = one.has(kHasQos); more;) {
    if (at + 4 > one.body.size()) return {};
    more = one.number<std::uint16_t>(at) != kSentinel;
    at += 4 + (more ? (one.number<std::uint16_t>(at + 2) + 3U) / 4 * 4 : 0U);
  }
  if (at > one.body.size()) return {};
  return at;
}

constexpr std::string_view kBehindItsEnd = "it has data that begins behind its end";

std::string_view wrong_data(const Submessage& one) {
  constexpr std::size_t kFixed = 20;
  return payload_of(one, kFixed) ? std::string_view() : kBehindItsEnd;
}

/// Whether Fast DDS would write behind the memory of a sample: at the begin of each fragment that has not
/// come it keeps a number, also where the last one is shorter. There may be room: the memory is in units of
/// 16 bytes, together with 12 bytes of Fast DDS and 8 of the allocator.
bool has_no_room(std::uint64_t sample, std::uint64_t fragment) {
  constexpr std::uint64_t kNumber = 4;
  constexpr std::uint64_t kUnit = 16;
  constexpr std::uint64_t kBefore = 12 + 8;
  const std::uint64_t last = sample % fragment;
  const std::uint64_t room = (kUnit - (sample + kBefore) % kUnit) % kUnit;
  return last > 0 && last + room < kNumber;
}

/// Fragments must be whole, and among those of a sample that is not too large.
std::string_view wrong_fragments(const Submessage& one) {
  constexpr std::size_t kFixed = 32;
  constexpr std::size_t kFirst = 20;
  constexpr std::size_t kCount = 24;
  constexpr std::size_t kSize = 26;
  constexpr std::size_t kSampleSize = 28;
  constexpr std::uint64_t kSmallest = 4;
  constexpr std::string_view kNotThere = "it has fragments that its sample does not have";
  const auto payload = payload_of(one, kFixed);
  if (!payload) return kBehindItsEnd;
  const std::uint64_t first = one.number<std::uint32_t>(kFirst);
  const std::uint64_t count = one.number<std::uint16_t>(kCount);
  const std::uint64_t size = one.number<std::uint16_t>(kSize);
  const std::uint64_t sample = one.number<std::uint32_t>(kSampleSize);
  if (sample > (one.of_discovery() ? kLargestAnnouncement : kLargestSample))
    return "it has a part of a sample that is too large: 256 MB are the most, and 1 MB for discovery";
  if (size < kSmallest || has_no_room(sample, size)) return "it has fragments that are too small";
  if (first == 0 || count == 0 || (first + count - 2) * size >= sample) return kNotThere;
  const std::uint64_t here = std::min(count * size, sample - (first - 1) * size);
  return here <= one.body.size() - *payload ? std::string_view() : kNotThere;
}

std::string_view wrong_gap(const Submessage& one) {
  constexpr std::size_t kBegin = 8;
  constexpr std::size_t kEnd = 16;  // the first one that may come
  const std::uint64_t begin = one.sequence(kBegin);
  const std::uint64_t end = one.sequence(kEnd);
  return end <= begin || end - begin <= kLongestGap ? std::string_view() : "it has a gap of too many samples";
}

std::string_view wrong_heartbeat(const Submessage& one) {
  constexpr std::size_t kFirst = 8;
  return one.sequence(kFirst) <= kMostSamples
             ? std::string_view()
             : "it is of a publisher that says that it has sent too many samples";
}

/// Where submessages have sequence numbers.
std::span<const std::size_t> sequences_of(std::byte id) {
  static constexpr std::array<std::size_t, 1> kOfDatum = {12};
  static constexpr std::array<std::size_t, 2> kOfRange = {8, 16};
  if (id == kData || id == kDataFrag) return kOfDatum;
  if (id == kGap || id == kHeartbeat) return kOfRange;
  if (id == kAckNack || id == kNackFrag || id == kHeartbeatFrag) return std::span(kOfRange).first(1);
  return {};
}

/// They must be there, since Fast DDS does not look where a submessage ends; and it ends its process where
/// some computations with them overflow.
std::string_view wrong_sequences(const Submessage& one) {
  for (const std::size_t at : sequences_of(one.id)) {
    if (at + 8 > one.body.size()) return "it has a part that is too short";
    if (one.sequence(at) >= kEndOfSequences) return "it has a number that no sample can have";
  }
  return {};
}

/// Empty: nothing.
std::string_view wrong_with(const Submessage& one) {
  if (const auto wrong = wrong_sequences(one); !wrong.empty()) return wrong;
  if (one.id == kData) return wrong_data(one);
  if (one.id == kDataFrag) return wrong_fragments(one);
  if (one.id == kHeartbeat) return wrong_heartbeat(one);
  return one.id == kGap ? wrong_gap(one) : std::string_view();
}

}  // namespace

Gid sender_of(std::span<const std::byte> message) {
  Gid sender{};
  if (message.size() >= kMessageHeader) {
    std::ranges::copy(message.subspan(kPrefix, kPrefixSize),
                      std::as_writable_bytes(std::span(sender)).begin());
  }
  return sender;
}

std::vector<Acknowledgement> acknowledgements_in(std::span<const std::byte> message) {
  std::vector<Acknowledgement> found;
  Acknowledgement current{sender_of(message), {}};
  const auto reader = std::as_writable_bytes(std::span(current.reader));
  const auto writer = std::as_writable_bytes(std::span(current.writer));
  for_each_submessage(message, [&](const Submessage& one) {
    // Participants of one process share messages.
    if (one.id == kInfoSource && one.body.size() >= kPrefix + kPrefixSize)
      std::ranges::copy(one.body.subspan(kPrefix, kPrefixSize), reader.begin());
    if (one.id == kInfoDestination && one.body.size() >= kPrefixSize)
      std::ranges::copy(one.body.first(kPrefixSize), writer.begin());
    if (one.id != kAckNack || one.body.size() < 8 || one.body[7] != kWriterOfUser) return;
    std::ranges::copy(one.body.first(4), reader.begin() + kPrefixSize);
    std::ranges::copy(one.body.subspan(4, 4), writer.begin() + kPrefixSize);
    found.push_back(current);
  });
  return found;
}

ReadableMessage readable_by_fast_dds(std::span<const std::byte> message) {
  ReadableMessage made;
  for_each_submessage(message, [&](const Submessage& one) {
    const std::string_view wrong = wrong_with(one);
    if (wrong.empty() && !is_departure(one)) return;
    if (made.bytes.empty()) made.bytes.assign(message.begin(), message.end());
    if (wrong.empty()) {
      std::byte& flags = made.bytes[one.begin + 1];
      flags = (flags & ~kHasKey) | kHasData;
    } else {
      made.bytes[one.begin] |= kOfVendor;
      made.refused = wrong;
    }
  });
  return made;
}

}  // namespace segue::ros2
