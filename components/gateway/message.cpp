// SPDX-License-Identifier: Apache-2.0
#include "message.hpp"

#include <segue/base/mutex.hpp>

#include <dds/ddsi/q_misc.h>
#include <dds/ddsi/q_protocol.h>
#include <dds/ddsi/q_radmin.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <new>
#include <utility>
#include <vector>

namespace gateway {
namespace {

/// Smaller blocks are the allocator's business.
constexpr std::size_t kLeastKept = 256UL << 10U;
/// The most bytes of all blocks together that are kept.
constexpr std::size_t kMostKept = 256UL << 20U;

struct Free {
  std::byte* data = nullptr;
  std::size_t capacity = 0;
};

struct FreeBlocks {
  segue::Mutex mutex;
  std::vector<Free> blocks SEGUE_GUARDED_BY(mutex);
  std::size_t total SEGUE_GUARDED_BY(mutex) = 0;

  /// The smallest one that fits and is not much too large.
  Free take(std::size_t size) {
    const segue::Lock lock(mutex);
    auto best = blocks.end();
    for (auto block = blocks.begin(); block != blocks.end(); ++block) {
      const bool fits = block->capacity >= size && block->capacity / 2 <= size;
      if (fits && (best == blocks.end() || block->capacity < best->capacity)) best = block;
    }
    if (best == blocks.end()) return {};
    const Free found = *best;
    total -= found.capacity;
    blocks.erase(best);
    return found;
  }

  bool keep(const Free& block) {
    const segue::Lock lock(mutex);
    if (block.capacity > kMostKept - total) return false;
    blocks.push_back(block);
    total += block.capacity;
    return true;
  }
};

/// Lives as long as the process, since Cyclone's threads may free messages until its end.
FreeBlocks& free_blocks() {
  static auto& blocks = *new FreeBlocks;
  return blocks;
}

struct Freed {
  const Unacknowledged* writer = nullptr;
  std::uint64_t count = 0;
};
thread_local Freed freed_here;

std::size_t padded(std::size_t size) {
  return (size + 3) / 4 * 4;
}

const Message& message_of(const ddsi_serdata* data) {
  return *static_cast<const Message*>(data);
}

/// Makes a message without throwing, since C code calls this; nullptr means that the sample is lost.
Message* make_message(const ddsi_sertype* type, ddsi_serdata_kind kind, std::size_t size) noexcept {
  try {
    return new Message(*type, kind, size);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

bool same_key(const ddsi_serdata*, const ddsi_serdata*) {
  return true;
}

std::uint32_t size_of(const ddsi_serdata* data) {
  return static_cast<std::uint32_t>(message_of(data).size);
}

/// Where the writer's number of a sample stands in the packet. Cyclone has turned it to this machine's byte
/// order.
std::uint64_t sequence_of(const nn_rdata& fragment) {
  if (fragment.submsg_zoff == 0) return 0;
  Data_DataFrag_common_t header;
  std::memcpy(&header, NN_RMSG_PAYLOADOFF(fragment.rmsg, NN_RDATA_SUBMSG_OFF(&fragment)), sizeof header);
  return ::fromSN(header.writerSN);
}

/// Fragments are in order and may overlap.
ddsi_serdata* from_network(const ddsi_sertype* type, ddsi_serdata_kind kind, const nn_rdata* fragment,
                           std::size_t size) {
  Message* message = make_message(type, kind, size);
  if (message == nullptr) return nullptr;
  message->sequence = sequence_of(*fragment);
  std::size_t done = 0;
  for (; fragment != nullptr && done < size; fragment = fragment->nextfrag) {
    if (fragment->maxp1 <= done) continue;
    const unsigned char* payload = NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
    const std::size_t end = std::min<std::size_t>(fragment->maxp1, size);
    std::memcpy(message->block.data() + done, payload + (done - fragment->min), end - done);
    done = end;
  }
  return message;
}

ddsi_serdata* from_parts(const ddsi_sertype* type, ddsi_serdata_kind kind, ddsrt_msg_iovlen_t count,
                         const ddsrt_iovec_t* parts, std::size_t size) {
  Message* message = make_message(type, kind, size);
  if (message == nullptr) return nullptr;
  std::size_t done = 0;
  for (ddsrt_msg_iovlen_t i = 0; i < count && done < size; ++i) {
    const std::size_t part = std::min<std::size_t>(parts[i].iov_len, size - done);
    std::memcpy(message->block.data() + done, parts[i].iov_base, part);
    done += part;
  }
  return message;
}

ddsi_serdata* from_key(const ddsi_sertype* type, const ddsi_keyhash_t*) {
  return make_message(type, SDK_KEY, 0);
}

ddsi_serdata* from_sample(const ddsi_sertype*, ddsi_serdata_kind, const void*) {
  return nullptr;  // only messages are written
}

void copy_out(const ddsi_serdata* data, std::size_t offset, std::size_t size, void* to) {
  std::memcpy(to, message_of(data).block.data() + offset, size);
}

ddsi_serdata* lend(const ddsi_serdata* data, std::size_t offset, std::size_t size, ddsrt_iovec_t* part) {
  part->iov_base = message_of(data).block.data() + offset;
  part->iov_len = size;
  return ::ddsi_serdata_ref(data);
}

void take_back(ddsi_serdata* data, const ddsrt_iovec_t*) {
  ::ddsi_serdata_unref(data);
}

bool to_sample(const ddsi_serdata*, void*, void**, void*) {
  return false;  // only messages are read
}

ddsi_serdata* without_value(const ddsi_serdata* data) {
  Message* message = make_message(data->type, SDK_KEY, 0);
  if (message != nullptr) message->type = nullptr;
  return message;
}

bool no_sample(const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) {
  return true;
}

void destroy(ddsi_serdata* data) {
  delete static_cast<Message*>(data);
}

std::size_t print(const ddsi_sertype*, const ddsi_serdata* data, char* text, std::size_t size) {
  return static_cast<std::size_t>(std::snprintf(text, size, "%zu bytes of CDR", message_of(data).size));
}

void key_hash(const ddsi_serdata*, ddsi_keyhash_t* hash, bool) {
  std::memset(hash, 0, sizeof *hash);
}

constexpr ddsi_serdata_ops kMessageOperations = [] {
  ddsi_serdata_ops ops{};
  ops.eqkey = &same_key;
  ops.get_size = &size_of;
  ops.from_ser = &from_network;
  ops.from_ser_iov = &from_parts;
  ops.from_keyhash = &from_key;
  ops.from_sample = &from_sample;
  ops.to_ser = &copy_out;
  ops.to_ser_ref = &lend;
  ops.to_ser_unref = &take_back;
  ops.to_sample = &to_sample;
  ops.to_untyped = &without_value;
  ops.untyped_to_sample = &no_sample;
  ops.free = &destroy;
  ops.print = &print;
  ops.get_keyhash = &key_hash;
  return ops;
}();

void free_type(ddsi_sertype* type) {
  ::ddsi_sertype_fini(type);
  delete type;
}

void no_samples(const ddsi_sertype*, void*, std::size_t) {}
void no_memory(void**, const ddsi_sertype*, void*, std::size_t, std::size_t) {}
void nothing_to_free(const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {}

bool same_type(const ddsi_sertype*, const ddsi_sertype*) {
  return true;  // the names are the same already
}

std::uint32_t type_hash(const ddsi_sertype*) {
  return 0;
}

const ddsi_sertype_ops kTypeOperations = [] {
  ddsi_sertype_ops ops{};
  ops.version = &::ddsi_sertype_v0;
  ops.free = &free_type;
  ops.zero_samples = &no_samples;
  ops.realloc_samples = &no_memory;
  ops.free_samples = &nothing_to_free;
  ops.equal = &same_type;
  ops.hash = &type_hash;
  return ops;
}();

}  // namespace

Block::Block(std::size_t size) {
  const std::size_t wanted = std::max<std::size_t>(padded(size), 4);
  if (wanted >= kLeastKept) {
    const Free found = free_blocks().take(wanted);
    data_ = found.data;
    capacity_ = found.capacity;
  }
  if (data_ == nullptr) {
    data_ = static_cast<std::byte*>(::operator new(wanted));
    capacity_ = wanted;
  }
  // The padding of the last word is sent as well.
  std::memset(data_ + wanted - 4, 0, 4);
}

Block::~Block() {
  if (capacity_ >= kLeastKept && free_blocks().keep({data_, capacity_})) return;
  ::operator delete(data_);
}

Message::Message(const ddsi_sertype& message_type, ddsi_serdata_kind message_kind, std::size_t message_size)
    : ddsi_serdata{}, block(message_size), size(message_size) {
  ::ddsi_serdata_init(this, &message_type, message_kind);
  hash = message_type.serdata_basehash;
}

Message::~Message() {
  if (writer == nullptr) return;
  freed_here = {writer.get(), freed_here.writer == writer.get() ? freed_here.count + 1 : 1};
  writer->messages.fetch_sub(1, std::memory_order_release);
}

std::uint64_t Unacknowledged::take_freed_here() const noexcept {
  const Freed freed = std::exchange(freed_here, {});
  return freed.writer == this ? freed.count : 0;
}

void Message::count_for(const std::shared_ptr<Unacknowledged>& counter) {
  writer = counter;
  writer->messages.fetch_add(1, std::memory_order_relaxed);
}

Topic::Topic(dds_entity_t participant, const std::string& name, const std::string& type) {
  auto* made = new ddsi_sertype{};
  ::ddsi_sertype_init_flags(made, type.c_str(), &kTypeOperations, &kMessageOperations,
                            DDSI_SERTYPE_FLAG_TOPICKIND_NO_KEY);
  made->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  ddsi_sertype* registered = made;
  entity_ = ::dds_create_topic_sertype(participant, name.c_str(), &registered, nullptr, nullptr, nullptr);
  if (entity_ < 0) {
    ::ddsi_sertype_unref(made);
    return;
  }
  type_ = registered;
}

Topic& Topic::operator=(Topic&& other) noexcept {
  std::swap(entity_, other.entity_);
  std::swap(type_, other.type_);
  return *this;
}

Topic::~Topic() {
  if (entity_ > 0) ::dds_delete(entity_);
}

}  // namespace gateway
