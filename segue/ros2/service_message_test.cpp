// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/dds_names.hpp>
#include <segue/ros2/service_message.hpp>

#include <gtest/gtest.h>

#include <initializer_list>

namespace segue::ros2 {
namespace {

std::vector<std::byte> bytes_of(std::initializer_list<int> numbers) {
  std::vector<std::byte> bytes;
  for (const int number : numbers)
    bytes.push_back(static_cast<std::byte>(number));
  return bytes;
}

TEST(ServiceMessage, HasItsIdentifierAfterTheHeader) {
  const auto message = bytes_of({0, 1, 0, 0, 42});
  const auto whole = with_request_id({0x0102030405060708U, 9}, message);
  EXPECT_EQ(whole, bytes_of({0, 1, 0, 0, 8, 7, 6, 5, 4, 3, 2, 1, 9, 0, 0, 0, 0, 0, 0, 0, 42}));
  const auto parts = split_request_id(whole);
  ASSERT_TRUE(parts);
  EXPECT_EQ(parts->id, (RequestId{0x0102030405060708U, 9}));
  EXPECT_EQ(parts->message, message);
}

TEST(ServiceMessage, IsReadInEitherByteOrder) {
  const auto parts =
      split_request_id(bytes_of({0, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 0, 0, 0, 0, 0, 0, 0, 9, 42}));
  ASSERT_TRUE(parts);
  EXPECT_EQ(parts->id, (RequestId{0x0102030405060708U, 9}));
  EXPECT_EQ(parts->message, bytes_of({0, 0, 0, 0, 42}));
}

TEST(ServiceMessage, IsRefusedWhereItIsTooShort) {
  const auto whole = with_request_id({1, 2}, bytes_of({0, 1, 0, 0}));
  EXPECT_TRUE(split_request_id(whole));
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_FALSE(split_request_id(std::span(whole).first(size))) << size;
}

TEST(ServiceMessage, ClientsAreNamedAsCycloneDoes) {
  Gid client{};
  client[0] = 0x01;
  client[1] = 0x10;
  client[15] = 0xab;
  EXPECT_EQ(client_user_data(client), "clientid=1.10.0.0.0.0.0.0.0.0.0.0.0.0.0.ab;");
  EXPECT_EQ(mapping_of(client), ServiceMapping::Cyclone);
  client[1] = 0x0f;
  EXPECT_EQ(mapping_of(client), ServiceMapping::FastDds);
}

TEST(ServiceNames, AreThoseOfRos2) {
  EXPECT_EQ(dds_request_name("/arm/add"), "rq/arm/addRequest");
  EXPECT_EQ(dds_response_name("add"), "rr/addReply");
  EXPECT_FALSE(dds_request_name("/a b"));
}

}  // namespace
}  // namespace segue::ros2
