// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>
#include <segue/base/shared_memory_options.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>

namespace segue::link {

/// Names the memory of one life of one process; random, never 0, never used again.
using Incarnation = std::uint64_t;

/// What another process needs to map this one's memory: two sealed memfds. Payloads can only be mapped for
/// reading by others.
struct MemoryOffer {
  Incarnation incarnation = 0;
  Descriptor payload;
  Descriptor control;
};

struct MemoryUsage {
  std::size_t payload_used = 0;  ///< bytes in blocks that are handed out
  std::size_t payload_touched = 0;
  std::size_t control_used = 0;
  std::size_t connections = 0;  ///< endpoints that stand
  std::size_t peers = 0;        ///< processes mapped
};

/// This process's part of the memory that the processes of a host share, and its maps of the others'.
///
/// Payload pool: where samples lie that leave the process, written by it alone; output ports take theirs from
/// there from their first connection to another process on. Control pool: the rings of connections into this
/// process and the doorbells by which other processes wake its threads. All functions are thread safe.
class SharedMemory {
 public:
  /// One for each process (more are possible, but a thread is woken through the first alone that has a
  /// connection to a task of it). Prefaulting takes about 0.9 ms for each MB. ResourceExhausted.
  static Result<std::shared_ptr<SharedMemory>> create(const SharedMemoryOptions& options = {});
  /// Ends all connections.
  virtual ~SharedMemory() = default;
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;

  [[nodiscard]] virtual Incarnation incarnation() const = 0;
  /// Fresh descriptors for a peer; ResourceExhausted where there are none.
  [[nodiscard]] virtual Result<MemoryOffer> offer() const = 0;

  /// Maps a peer's memory (once; again is free). The offer is untrusted: sizes and seals are checked.
  virtual Result<void> admit(const MemoryOffer& peer) = 0;
  [[nodiscard]] virtual bool knows(Incarnation peer) const = 0;
  /// The peer is dead, or is never to be talked to again: every connection with it ends, what it held comes
  /// back, its memory is unmapped when the last sample that lies there is given back.
  virtual void forget(Incarnation peer) = 0;

  [[nodiscard]] virtual MemoryUsage usage() const = 0;

 protected:
  SharedMemory() = default;
};

}  // namespace segue::link
