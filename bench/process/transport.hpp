// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board.hpp"

#include <memory>
#include <string>
#include <vector>

namespace bench {

/// The writer's end of something that carries samples.
class Writer {
 public:
  Writer() = default;
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  virtual ~Writer() = default;
  /// False where it cannot be sent now.
  virtual bool send(std::uint64_t number) = 0;
};

/// Something that carries samples from process to process.
class Transport {
 public:
  Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;
  virtual ~Transport() = default;

  [[nodiscard]] virtual std::string name() const = 0;
  [[nodiscard]] virtual bool carries(std::size_t bytes) const = 0;
  /// In the writer's process, once; null where it does not work.
  virtual std::unique_ptr<Writer> open(const End& end) = 0;
  /// In the reader's process: notes all samples on the board until the last.
  virtual void read(const End& end) = 0;
};

using Transports = std::vector<std::unique_ptr<Transport>>;

/// Threads of two processes that hand over by a futex in memory they share; no sample is carried.
std::unique_ptr<Transport> make_futex();
std::unique_ptr<Transport> make_unix_socket();

/// How a sample gets into the shared memory: written where it is read; copied from an object without
/// pointers; or with a vector inside, so that it is written and read in the flat layout.
enum class SegueWay { Loaned, Copied, Flat };
std::unique_ptr<Transport> make_segue(SegueWay way);

/// Peers: null where they were not there when this was built.
std::unique_ptr<Transport> make_cyclone();
/// Needs a RouDi that runs.
std::unique_ptr<Transport> make_iceoryx();

/// iceoryx's daemon, with memory for samples of those sizes. Ends with this.
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
