// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/dds/topic/TopicDataType.hpp>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <new>
#include <span>
#include <string>
#include <vector>

namespace ros2 {

/// Where the bytes of a message come from: CDR, the encapsulation header included.
class MessageSource {
 public:
  [[nodiscard]] virtual std::size_t size() const noexcept = 0;
  /// Fills all of `bytes`, which are as many as size() said. False: there is no message.
  virtual bool write(std::span<std::byte> bytes) const noexcept = 0;

 protected:
  ~MessageSource() = default;
};

/// Bytes that are there already, and stay as long as this.
class BytesSource final : public MessageSource {
 public:
  explicit BytesSource(std::span<const std::byte> bytes) : bytes_(bytes) {}
  [[nodiscard]] std::size_t size() const noexcept override { return bytes_.size(); }
  bool write(std::span<std::byte> bytes) const noexcept override {
    std::ranges::copy(bytes_, bytes.begin());
    return true;
  }

 private:
  std::span<const std::byte> bytes_;
};

/// Where the bytes of a message go, in the thread that takes it.
class MessageSink {
 public:
  virtual bool take(std::span<const std::byte> bytes) noexcept = 0;

 protected:
  ~MessageSink() = default;
};

/// Keeps the bytes of one message.
class BytesSink final : public MessageSink {
 public:
  bool take(std::span<const std::byte> message) noexcept override {
    try {
      bytes.assign(message.begin(), message.end());
      return true;
    } catch (const std::bad_alloc&) {
      return false;
    }
  }
  std::vector<std::byte> bytes;
};

/// A type of Fast DDS whose structure Fast DDS does not know: messages are bytes, written from a
/// MessageSource and taken by a MessageSink. So one library serves all types, as rmw_fastrtps and
/// rmw_cyclonedds do it.
class OpaqueType final : public eprosima::fastdds::dds::TopicDataType {
 public:
  explicit OpaqueType(const std::string& name);

  bool serialize(void* source, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override;
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* sink) override;
  std::function<std::uint32_t()> getSerializedSizeProvider(void* source) override;
  void* createData() override { return nullptr; }
  void deleteData(void*) override {}
  bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
};

}  // namespace ros2
