// SPDX-License-Identifier: Apache-2.0
#include "opaque_type.hpp"

namespace ros2 {
namespace {

/// How much memory is prepared for each message; larger ones get more when they come.
constexpr std::uint32_t kPreparedBytes = 512;

}  // namespace

using eprosima::fastrtps::rtps::SerializedPayload_t;

OpaqueType::OpaqueType(const std::string& name) {
  setName(name.c_str());
  m_typeSize = kPreparedBytes;
  m_isGetKeyDefined = false;
  auto_fill_type_information(false);
  auto_fill_type_object(false);
}

bool OpaqueType::serialize(void* source, SerializedPayload_t* payload) {
  const auto& message = *static_cast<const MessageSource*>(source);
  const std::size_t size = message.size();
  if (size == 0 || payload->max_size < size) return false;
  payload->encapsulation = CDR_LE;
  payload->length = static_cast<std::uint32_t>(size);
  return message.write(std::as_writable_bytes(std::span(payload->data, size)));
}

bool OpaqueType::deserialize(SerializedPayload_t* payload, void* sink) {
  return static_cast<MessageSink*>(sink)->take(std::as_bytes(std::span(payload->data, payload->length)));
}

std::function<std::uint32_t()> OpaqueType::getSerializedSizeProvider(void* source) {
  return [source] { return static_cast<std::uint32_t>(static_cast<const MessageSource*>(source)->size()); };
}

}  // namespace ros2
