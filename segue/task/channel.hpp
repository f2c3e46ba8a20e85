// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task/sample.hpp>

#include <cstddef>
#include <cstdint>

namespace segue::task {

class Executor;

/// Notified when a new sample waits at an input port.
class SampleListener {
 public:
  virtual void sample_arrived() noexcept = 0;
  /// The executor on which sample_arrived() makes something run.
  [[nodiscard]] virtual Executor& runner() noexcept = 0;

 protected:
  ~SampleListener() = default;
};

/// The writer's end of a connection, as the output port sees it. Links implement it.
class WriterEnd {
 public:
  virtual ~WriterEnd() = default;
  /// Passes a sample on, adding a reference of its own, and wakes the reader. False: refused and counted. The
  /// writer only; real-time safe.
  virtual bool push(SampleSlot& sample) noexcept = 0;
  /// Removes the connection from its ports. Idempotent; any thread; waits for a write or read in progress.
  virtual void disconnect() = 0;
  /// How many samples of the writer's pool it may hold at once, the reader's included.
  [[nodiscard]] virtual std::size_t capacity() const = 0;
  /// Whether `other`, of the same port, leads to the same reader with the same policy.
  [[nodiscard]] virtual bool same_as(const WriterEnd& other) const = 0;
};

/// The reader's end of a connection, as the input port sees it. Links implement it.
class ReaderEnd {
 public:
  virtual ~ReaderEnd() = default;
  /// The oldest sample that waits, or none. The reader only; real-time safe.
  virtual SampleRef pull() noexcept = 0;
  /// Whether pull() would find a sample. Any thread that holds this end.
  [[nodiscard]] virtual bool pending() const noexcept = 0;
  virtual void disconnect() = 0;
  /// The port has got a new listener to notify of samples; nullptr: none. When this returns, no writer calls
  /// the previous one any more through this connection. Any thread, one at a time.
  virtual void set_listener(SampleListener* listener) = 0;
  /// Unique within the process.
  [[nodiscard]] virtual std::uint64_t number() const noexcept = 0;
};

/// A number for ReaderEnd::number(). Any thread.
std::uint64_t next_connection_number() noexcept;

}  // namespace segue::task
