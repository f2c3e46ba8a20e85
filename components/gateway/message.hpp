// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>

/// Topics of opaque CDR: Cyclone DDS carries the bytes of samples without knowing their structure, so that
/// one library serves every type. There are no keys, as in ROS 2.
namespace gateway {

/// The messages of one writer that Cyclone still holds: those that a reader has not acknowledged yet. Any
/// thread.
struct Unacknowledged {
  std::atomic<std::uint64_t> messages{0};  ///< a statistic: it grows before the message is passed on

  /// Messages that this thread has freed since the last call, or since it freed messages of other writers.
  /// For the callback that tells that a reader has left: the thread that calls it has freed, just before,
  /// what only that reader had not acknowledged. Acknowledgements are received in other threads.
  [[nodiscard]] std::uint64_t take_freed_here() const noexcept;
};

/// The memory of a message. Large blocks are kept for the next one, since the system would have to clear a
/// new block page by page.
class Block {
 public:
  /// May throw std::bad_alloc.
  explicit Block(std::size_t size);
  Block(const Block&) = delete;
  Block& operator=(const Block&) = delete;
  ~Block();
  [[nodiscard]] std::byte* data() const { return data_; }

 private:
  std::byte* data_ = nullptr;
  std::size_t capacity_ = 0;
};

/// One sample as CDR with its encapsulation header. Reference counted by Cyclone.
struct Message : ddsi_serdata {
  /// Makes room for `size` bytes, which the caller writes. May throw std::bad_alloc.
  Message(const ddsi_sertype& message_type, ddsi_serdata_kind message_kind, std::size_t message_size);
  Message(const Message&) = delete;
  Message& operator=(const Message&) = delete;
  ~Message();

  /// Counts the message as long as it exists.
  void count_for(const std::shared_ptr<Unacknowledged>& counter);
  [[nodiscard]] std::span<std::byte> bytes() const { return {block.data(), size}; }

  Block block;
  std::size_t size;
  std::uint64_t sequence = 0;  ///< the number that its writer gave it, from 1; 0: it was not received
  std::shared_ptr<Unacknowledged> writer;  ///< counts this message; nullptr: nobody does
};

/// A counted reference to a message, as Cyclone hands it out and takes it over.
struct Unreference {
  void operator()(Message* message) const { ::ddsi_serdata_unref(message); }
};
using MessageRef = std::unique_ptr<Message, Unreference>;

/// The largest message that DDS carries, in bytes.
inline constexpr std::size_t kLargestMessage = 0xfff00000;

/// An endpoint's topic. Creating it registers the type; destroying it leaves that to the endpoints.
class Topic {
 public:
  Topic() = default;
  /// entity() is negative, a DDS return code, where the topic cannot be created.
  Topic(dds_entity_t participant, const std::string& name, const std::string& type);
  Topic(const Topic&) = delete;
  Topic& operator=(const Topic&) = delete;
  Topic(Topic&& other) noexcept { *this = std::move(other); }
  Topic& operator=(Topic&& other) noexcept;
  ~Topic();

  [[nodiscard]] dds_entity_t entity() const { return entity_; }
  /// Requires a topic.
  [[nodiscard]] const ddsi_sertype& type() const { return *type_; }

 private:
  dds_entity_t entity_ = 0;
  const ddsi_sertype* type_ = nullptr;
};

}  // namespace gateway
