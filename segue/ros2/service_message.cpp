// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/service_message.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace segue::ros2 {
namespace {

constexpr std::size_t kCdrHeader = 4;
constexpr std::size_t kIdSize = 16;
static_assert(std::endian::native == std::endian::little);

bool is_little_endian(std::span<const std::byte> message) {
  return (message[1] & std::byte{1}) != std::byte{0};
}

template <class Number>
Number number_at(std::span<const std::byte> bytes, bool little) {
  std::array<std::byte, sizeof(Number)> ordered{};
  std::ranges::copy(bytes.first(sizeof(Number)), ordered.begin());
  if (!little) std::ranges::reverse(ordered);
  return std::bit_cast<Number>(ordered);
}

template <class Number>
void put(std::vector<std::byte>& bytes, Number number, bool little) {
  auto ordered = std::bit_cast<std::array<std::byte, sizeof(Number)>>(number);
  if (!little) std::ranges::reverse(ordered);
  bytes.insert(bytes.end(), ordered.begin(), ordered.end());
}

std::string user_data(std::string_view key, const Gid& whose) {
  std::string text(key);
  for (std::size_t i = 0; i < whose.size(); ++i)
    text += fmt::format("{}{:x}", i == 0 ? "=" : ".", whose[i]);
  return text + ";";
}

}  // namespace

ServiceMapping mapping_of(const Gid& endpoint) {
  return endpoint[0] == 0x01 && endpoint[1] == 0x10 ? ServiceMapping::Cyclone : ServiceMapping::FastDds;
}

std::vector<std::byte> with_request_id(const RequestId& id, std::span<const std::byte> message) {
  std::vector<std::byte> bytes(message.begin(), message.begin() + kCdrHeader);
  const bool little = is_little_endian(message);
  put(bytes, id.client, little);
  put(bytes, id.sequence, little);
  bytes.insert(bytes.end(), message.begin() + kCdrHeader, message.end());
  return bytes;
}

std::optional<IdentifiedMessage> split_request_id(std::span<const std::byte> bytes) {
  if (bytes.size() < kCdrHeader + kIdSize) return {};
  const bool little = is_little_endian(bytes);
  IdentifiedMessage parts;
  parts.id.client = number_at<std::uint64_t>(bytes.subspan(kCdrHeader), little);
  parts.id.sequence = number_at<std::int64_t>(bytes.subspan(kCdrHeader + 8), little);
  parts.message.assign(bytes.begin(), bytes.begin() + kCdrHeader);
  parts.message.insert(parts.message.end(), bytes.begin() + kCdrHeader + kIdSize, bytes.end());
  return parts;
}

std::string client_user_data(const Gid& client) {
  return user_data("clientid", client);
}

std::string server_user_data(const Gid& server) {
  return user_data("serviceid", server);
}

}  // namespace segue::ros2
