// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>
#include <segue/base/shared_memory_options.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>

namespace segue::sample_link {

/// Identifies the memory of one process during its lifetime; random, never 0, never reused.
using Incarnation = std::uint64_t;

/// Two sealed memfds with which another process maps this one's memory. It can map the payload pool for
/// reading only.
struct MemoryOffer {
  Incarnation incarnation = 0;
  Descriptor payload;
  Descriptor control;
};

struct MemoryUsage {
  std::size_t payload_used = 0;  ///< bytes in blocks that are in use
  std::size_t payload_touched = 0;
  std::size_t control_used = 0;
  std::size_t connections = 0;  ///< connected endpoints
  std::size_t peers = 0;        ///< processes mapped
};

/// The memory that this process shares with others of its host, and its mappings of theirs.
///
/// The payload pool holds samples that leave the process and is written by it alone; an output port uses it
/// from its first connection to another process on. The control pool holds the rings of connections into this
/// process and the doorbells with which other processes wake its threads. All functions are thread safe.
class SharedMemory {
 public:
  /// Intended once for each process: with several, a thread can be woken only through the first that connects
  /// to one of its tasks. Prefaulting takes about 0.9 ms per MB. ResourceExhausted.
  static Result<std::shared_ptr<SharedMemory>> create(const SharedMemoryOptions& options = {});
  /// Ends all connections.
  virtual ~SharedMemory() = default;
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;

  [[nodiscard]] virtual Incarnation incarnation() const = 0;
  /// New descriptors for a peer; ResourceExhausted where the process has none left.
  [[nodiscard]] virtual Result<MemoryOffer> offer() const = 0;

  /// Maps a peer's memory; does nothing where it is mapped. The offer is untrusted: sizes and seals are
  /// checked.
  virtual Result<void> admit(const MemoryOffer& peer) = 0;
  [[nodiscard]] virtual bool knows(Incarnation peer) const = 0;
  /// For a peer that is dead or given up: ends every connection with it, reclaims the samples that it held,
  /// and unmaps its memory once the last sample that lies there is released. A peer that lives all the same
  /// may find samples that it still holds overwritten.
  virtual void forget(Incarnation peer) = 0;

  [[nodiscard]] virtual MemoryUsage usage() const = 0;

 protected:
  SharedMemory() = default;
};

}  // namespace segue::sample_link
