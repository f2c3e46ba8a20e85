// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board.hpp"

#include <memory>
#include <string>
#include <vector>

namespace bench {

/// The writer of a transport.
class Writer {
 public:
  Writer() = default;
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  virtual ~Writer() = default;
  /// False if it cannot be sent now.
  virtual bool send(std::uint64_t number) = 0;
};

/// Transports samples from one process to another.
class Transport {
 public:
  Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;
  virtual ~Transport() = default;

  [[nodiscard]] virtual std::string name() const = 0;
  [[nodiscard]] virtual bool carries(std::size_t bytes) const = 0;
  /// Called once in the writer's process; null on failure.
  virtual std::unique_ptr<Writer> open(const End& end) = 0;
  /// Called in the reader's process: records all samples on the board until the last one.
  virtual void read(const End& end) = 0;
};

using Transports = std::vector<std::unique_ptr<Transport>>;

/// Threads of two processes that wake each other with a futex in shared memory; no sample is transferred.
std::unique_ptr<Transport> make_futex();
std::unique_ptr<Transport> make_unix_socket();

/// How a sample is written to shared memory: in place; copied from an object without pointers; with a vector
/// inside, in the flat layout; or in place for a reader that spins before it sleeps.
enum class SegueWay { Loaned, Copied, Flat, Spinning };
std::unique_ptr<Transport> make_segue(SegueWay way);

/// Other middleware: null if not available at build time.
std::unique_ptr<Transport> make_cyclone();
/// Requires a running RouDi.
std::unique_ptr<Transport> make_iceoryx();

/// The daemon of iceoryx, with memory for samples of those sizes. The destructor ends it.
class RouDi {
 public:
  static std::unique_ptr<RouDi> start();
  ~RouDi();
  RouDi(const RouDi&) = delete;
  RouDi& operator=(const RouDi&) = delete;

 private:
  RouDi(int pid, std::string folder) : pid_(pid), folder_(std::move(folder)) {}
  int pid_;
  std::string folder_;
};

}  // namespace bench
