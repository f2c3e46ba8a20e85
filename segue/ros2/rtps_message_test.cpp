// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/rtps_message.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

namespace segue::ros2 {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
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
  append(bytes, {0, 0, little ? 16 : 0, little ? 0 : 16, 0, 0, 0, 0});
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
      EXPECT_EQ(readable_by_fast_dds(message).bytes, expected);
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
  EXPECT_EQ(readable_by_fast_dds(message).bytes, expected);
}

TEST(Departures, OtherMessagesAreLeftAlone) {
  Bytes message = header();
  EXPECT_TRUE(readable_by_fast_dds(message).bytes.empty());
  append_data(message, {0, 0, 0x03, 0xc2}, false);
  append_data(message, {0, 0, 0x12, 0x03}, true);
  EXPECT_TRUE(readable_by_fast_dds(message).bytes.empty());
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
  Gid reader;
  reader.fill(0xaa);
  std::ranges::copy(std::array<std::uint8_t, 4>{0, 0, 9, 4}, reader.begin() + 12);
  EXPECT_EQ(found.front().reader, reader);
  EXPECT_EQ(found.front().writer, (Gid{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 0, 0, 8, 3}));
}

/// A submessage of a writer of users; its sequence number is 1, and its body and its length have `size` bytes
/// more than what is given.
void append_submessage(Bytes& bytes, int id, int flags, const Bytes& body, std::size_t size) {
  const std::size_t length = body.size() + size;
  append(bytes, {id, flags | 1, static_cast<int>(length & 0xffU), static_cast<int>(length >> 8U)});
  bytes.insert(bytes.end(), body.begin(), body.end());
  bytes.resize(bytes.size() + size);
}

constexpr std::uint64_t kEndOfSequences = std::uint64_t{1} << 62U;
constexpr int kQos = 2;
constexpr int kPayload = 4;

/// Up to the inline QoS, which is so many bytes behind the field that says so.
Bytes data_body(int to_qos) {
  Bytes body;
  append(body, {0, 0, to_qos & 0xff, to_qos >> 8, 0, 0, 0, 0, 0, 0, 8, 3, 0, 0, 0, 0, 1, 0, 0, 0});
  return body;
}

struct Fragments {
  std::uint32_t first = 1;
  std::uint16_t count = 1;
  std::uint16_t size = 1000;
  std::uint32_t sample = 2500;
};

Bytes fragments_body(const Fragments& fragments, std::uint8_t kind = 0x03) {
  Bytes body = data_body(28);
  body[11] = std::byte{kind};
  const auto append_number = [&body](std::uint32_t value, int bytes) {
    for (int i = 0; i < bytes; ++i)
      body.push_back(static_cast<std::byte>(value >> (8 * i)));
  };
  append_number(fragments.first, 4);
  append_number(fragments.count, 2);
  append_number(fragments.size, 2);
  append_number(fragments.sample, 4);
  return body;
}

/// Why a message with this submessage is refused.
std::string_view refused(int id, int flags, const Bytes& body, std::size_t size) {
  Bytes message = header();
  append_submessage(message, id, flags, body, size);
  append_data(message, {0, 0, 0x12, 0x03}, false);
  const ReadableMessage readable = readable_by_fast_dds(message);
  if (readable.refused.empty()) {
    EXPECT_TRUE(readable.bytes.empty());
    return {};
  }
  message[20] |= std::byte{0x80};
  EXPECT_EQ(readable.bytes, message) << "the other submessage is as it was";
  return readable.refused;
}

TEST(ReadableMessages, HaveDataThatEndsBehindItsBegin) {
  constexpr int kData = 0x15;
  EXPECT_THAT(refused(kData, kPayload, data_body(16), 8), IsEmpty());
  EXPECT_THAT(refused(kData, 0, data_body(16), 0), IsEmpty()) << "an instance without a key has ended";
  EXPECT_THAT(refused(kData, kPayload, data_body(24), 8), IsEmpty()) << "fields of a later version";
  EXPECT_THAT(refused(kData, kPayload, data_body(24), 7), HasSubstr("begins behind its end"));
  EXPECT_THAT(refused(kData, kPayload, data_body(12), 8), HasSubstr("begins behind its end"));
  EXPECT_THAT(refused(kData, kPayload, data_body(0x8010), 40'000), HasSubstr("begins behind its end"));
  EXPECT_THAT(refused(kData, kPayload, Bytes(12), 0), HasSubstr("too short"));
}

TEST(ReadableMessages, HaveInlineQosThatEnds) {
  constexpr int kData = 0x15;
  Bytes body = data_body(16);
  append(body, {0x70, 0, 5, 0, 1, 2, 3, 4, 5, 0, 0, 0});  // a parameter, padded to a multiple of 4
  EXPECT_THAT(refused(kData, kPayload | kQos, body, 0), HasSubstr("behind its end")) << "no sentinel";
  append(body, {1, 0, 0, 0x70});  // the length of a sentinel does not count
  EXPECT_THAT(refused(kData, kPayload | kQos, body, 4), IsEmpty());
  EXPECT_THAT(refused(kData, kPayload | kQos, body, 0), IsEmpty());
  body[22] = std::byte{200};
  EXPECT_THAT(refused(kData, kPayload | kQos, body, 4), HasSubstr("behind its end"));
}

std::string_view refused(const Fragments& fragments, std::size_t payload, std::uint8_t kind = 0x03) {
  return refused(0x16, 0, fragments_body(fragments, kind), payload);
}

TEST(ReadableMessages, HaveFragmentsOfTheirSample) {
  EXPECT_THAT(refused({1, 1, 1000, 2500}, 1000), IsEmpty());
  EXPECT_THAT(refused({1, 3, 1000, 2500}, 2500), IsEmpty());
  EXPECT_THAT(refused({3, 1, 1000, 2500}, 500), IsEmpty());
  for (const auto& [fragments, payload] : {std::pair{Fragments{1, 1, 1000, 2500}, 999},
                                           {{3, 1, 1000, 2500}, 499},
                                           {{4, 1, 1000, 2500}, 1000},
                                           {{2, 3, 1000, 2500}, 1500},
                                           {{0, 1, 1000, 2500}, 1000},
                                           {{1, 0, 1000, 2500}, 1000},
                                           {{1, 3, 1000, 2500}, 2499},
                                           {{1, 1, 1000, 0}, 1000}}) {
    EXPECT_THAT(refused(fragments, static_cast<std::size_t>(payload)), HasSubstr("does not have"))
        << fragments.first << " " << fragments.count << " " << fragments.sample;
  }
}

TEST(ReadableMessages, HaveSamplesThatAreNotTooLarge) {
  constexpr auto kMost = static_cast<std::uint32_t>(kLargestSample);
  EXPECT_THAT(refused({1, 1, 1024, kMost}, 1024), IsEmpty());
  EXPECT_THAT(refused({1, 1, 1024, kMost + 4}, 1024), HasSubstr("too large"));
  constexpr auto kMostOfDiscovery = static_cast<std::uint32_t>(kLargestAnnouncement);
  EXPECT_THAT(refused({1, 1, 1024, kMostOfDiscovery}, 1024, 0xc2), IsEmpty());
  EXPECT_THAT(refused({1, 1, 1024, kMostOfDiscovery + 4}, 1024, 0xc2), HasSubstr("too large"));
}

TEST(ReadableMessages, HaveRoomForANumberInEachFragment) {
  EXPECT_THAT(refused({1, 1, 3, 24}, 3), HasSubstr("too small"));
  EXPECT_THAT(refused({1, 1, 1000, 2001}, 1000), IsEmpty()) << "its memory has 11 bytes more";
  EXPECT_THAT(refused({1, 1, 1004, 2009}, 1004), IsEmpty()) << "its memory has 3 bytes more";
  EXPECT_THAT(refused({1, 1, 1005, 2011}, 1005), HasSubstr("too small")) << "its memory has 1 byte more";
  EXPECT_THAT(refused({1, 1, 1004, 2012}, 1004), IsEmpty());
}

/// The identifiers of a reader and a writer, and two sequence numbers.
Bytes body_of_numbers(std::uint64_t first, std::uint64_t second) {
  Bytes made;
  append(made, {0, 0, 0, 0, 0, 0, 8, 3});
  for (const std::uint64_t one : {first, second}) {
    for (const int shift : {32, 40, 48, 56, 0, 8, 16, 24})
      made.push_back(static_cast<std::byte>(one >> shift));
  }
  return made;
}

TEST(ReadableMessages, HaveGapsThatEnd) {
  constexpr int kGap = 0x08;
  EXPECT_THAT(refused(kGap, 0, body_of_numbers(1, 1 + kLongestGap), 4), IsEmpty());
  EXPECT_THAT(refused(kGap, 0, body_of_numbers(7, 3), 4), IsEmpty());
  EXPECT_THAT(refused(kGap, 0, body_of_numbers(1, 2 + kLongestGap), 4), HasSubstr("gap of too many"));
  EXPECT_THAT(refused(kGap, 0, body_of_numbers(1, kEndOfSequences - 1), 4), HasSubstr("gap of too many"));
}

TEST(ReadableMessages, HaveHeartbeatsOfWritersThatHaveNotSentTooMuch) {
  constexpr int kHeartbeat = 0x07;
  EXPECT_THAT(refused(kHeartbeat, 0, body_of_numbers(1, kEndOfSequences - 1), 4), IsEmpty());
  EXPECT_THAT(refused(kHeartbeat, 0, body_of_numbers(kMostSamples, kMostSamples), 4), IsEmpty());
  EXPECT_THAT(refused(kHeartbeat, 0, body_of_numbers(kMostSamples + 1, kMostSamples), 4),
              HasSubstr("too many samples"));
}

TEST(ReadableMessages, HaveNumbersThatCanBeComputedWith) {
  const Bytes large = body_of_numbers(kEndOfSequences, kEndOfSequences);
  for (const int id : {0x06, 0x07, 0x08, 0x12, 0x13})
    EXPECT_THAT(refused(id, 0, large, 12), HasSubstr("a number that no sample can have")) << id;
  for (const int id : {0x06, 0x07, 0x08, 0x12, 0x13})
    EXPECT_THAT(refused(id, 0, Bytes(15), 0), HasSubstr("too short")) << id;
  Bytes body = data_body(16);
  body[15] = std::byte{0x40};
  EXPECT_THAT(refused(0x15, kPayload, body, 8), HasSubstr("a number that no sample can have"));
}

TEST(ReadableMessages, HavePartsThatBeginAtMultiplesOfFour) {
  Bytes message = header();
  append(message, {0x01, 0x01, 5, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  append_submessage(message, 0x07, 0, body_of_numbers(kEndOfSequences, 0), 4);
  EXPECT_THAT(readable_by_fast_dds(message).refused, HasSubstr("a number that no sample can have"));
}

TEST(ReadableMessages, MayHaveALastPartWithoutALength) {
  Bytes message = header();
  append(message, {0x16, 0x01, 0, 0});
  const Bytes body = fragments_body({1, 0x4001, 0xffff, 0x40000000});
  message.insert(message.end(), body.begin(), body.end());
  EXPECT_THAT(readable_by_fast_dds(message).refused, HasSubstr("too large"));
}

}  // namespace
}  // namespace segue::ros2
