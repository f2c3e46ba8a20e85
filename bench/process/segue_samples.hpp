// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../support/chain.hpp"
#include "handshake.hpp"
#include "transport.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

/// Samples of Segue between processes: their types, a writer and a reader.
namespace bench {

/// A sample of that many bytes, without pointers.
template <std::size_t N>
struct Block {
  std::int64_t sent_ns = 0;
  std::uint64_t number = 0;
  std::array<std::uint8_t, N - sizeof(Stamp)> data{};
};
template <>
struct Block<sizeof(Stamp)> {
  std::int64_t sent_ns = 0;
  std::uint64_t number = 0;
};

struct Grown {
  std::int64_t sent_ns = 0;
  std::uint64_t number = 0;
  std::vector<std::uint8_t> data;
};

SEGUE_TYPE(Block<16>, sent_ns, number)
SEGUE_TYPE(Block<64>, sent_ns, number, data)
SEGUE_TYPE(Block<1000>, sent_ns, number, data)
SEGUE_TYPE(Block<64000>, sent_ns, number, data)
SEGUE_TYPE(Block<1000000>, sent_ns, number, data)
SEGUE_TYPE(Block<10000000>, sent_ns, number, data)
SEGUE_TYPE(Block<100000000>, sent_ns, number, data)
SEGUE_TYPE(Grown, sent_ns, number, data)

/// Whether there is a block of that size.
[[nodiscard]] constexpr bool is_block(std::size_t bytes) {
  constexpr std::array<std::size_t, 7> kSizes = {16, 64, 1000, 64'000, 1'000'000, 10'000'000, 100'000'000};
  return std::ranges::find(kSizes, bytes) != kSizes.end();
}

/// Calls `use` with a null pointer to the block of that size.
template <class Use>
void with_block(std::size_t bytes, const Use& use) {
  switch (bytes) {
    case 16:
      return use(static_cast<Block<16>*>(nullptr));
    case 64:
      return use(static_cast<Block<64>*>(nullptr));
    case 1000:
      return use(static_cast<Block<1000>*>(nullptr));
    case 64'000:
      return use(static_cast<Block<64'000>*>(nullptr));
    case 1'000'000:
      return use(static_cast<Block<1'000'000>*>(nullptr));
    case 10'000'000:
      return use(static_cast<Block<10'000'000>*>(nullptr));
    default:
      return use(static_cast<Block<100'000'000>*>(nullptr));
  }
}

inline segue::Policy policy_for(std::size_t bytes) {
  return {segue::BufferKind::Buffer, bytes >= 10'000'000 ? 2U : 16U};
}

/// Memory for samples of that size; 0: of a process that only reads.
inline std::shared_ptr<segue::sample_link::SharedMemory> memory_for(std::size_t bytes) {
  segue::SharedMemoryOptions options;
  options.prefault = std::max(options.prefault, bytes * 4);
  auto memory = segue::sample_link::SharedMemory::create(options);
  if (!memory) require(std::move(memory.error()));
  return std::move(*memory);
}

using Endpoint = std::shared_ptr<segue::sample_link::SharedEndpoint>;
inline Endpoint required(segue::Result<Endpoint> made) {
  if (!made) require(std::move(made.error()));
  return std::move(*made);
}

template <class T>
void prime(segue::task::OutputPort<T>&, std::size_t) {}
inline void prime(segue::task::OutputPort<Grown>& port, std::size_t bytes) {
  port.prime({0, 0, std::vector<std::uint8_t>(bytes - sizeof(Stamp))});
}

/// Writes in place, in the memory that the reader at the other end of the socket reads.
template <class T>
class LoanWriter : public Writer {
 public:
  LoanWriter(int socket, std::size_t bytes) : memory_(memory_for(bytes)) {
    prime(source_->output, bytes);
    endpoint_ = required(connect_writer(*memory_, socket, source_->output, policy_for(bytes)));
  }

  bool send(std::uint64_t number) override {
    auto loan = output().loan();
    if (!loan) return false;
    loan->number = number;
    loan->sent_ns = clock_ns();
    return loan.publish() == segue::task::WriteResult::Written;
  }

 protected:
  segue::task::OutputPort<T>& output() { return source_->output; }

 private:
  std::shared_ptr<segue::sample_link::SharedMemory> memory_;
  std::unique_ptr<Source<T>> source_ = std::make_unique<Source<T>>();
  Endpoint endpoint_;
};

/// Records arrivals on the board.
template <class T>
class Noter final : public segue::task::Component {
 public:
  segue::task::InputPort<T> input{*this, "input"};
  Board* board = nullptr;
  std::atomic<bool> ended{false};

  void on_update() override {
    while (auto sample = input.take()) {
      if (board != nullptr) board->arrive({sample->sent_ns, sample->number});
      if (sample->number != kLast) continue;
      ended.store(true, std::memory_order_release);
      ended.notify_one();
    }
  }
};

/// Records all samples from the writer at the other end of the socket, until the last one.
template <class T>
void read_samples(int socket, const End& end, const segue::Activity& activity = {}) {
  const auto memory = memory_for(0);
  Bench bench;
  auto& noter = bench.run<Noter<T>>("noter", activity);
  noter.board = &end.board;
  const Endpoint endpoint = required(connect_reader(*memory, socket, noter.input, policy_for(end.bytes)));
  noter.ended.wait(false, std::memory_order_acquire);  // asleep, so that only the task's thread is measured
}

}  // namespace bench
