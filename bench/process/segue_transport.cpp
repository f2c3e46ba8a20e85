// SPDX-License-Identifier: Apache-2.0
#include "../support/chain.hpp"
#include "handshake.hpp"
#include "transport.hpp"

#include <array>
#include <cstdint>
#include <vector>

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

}  // namespace bench

SEGUE_TYPE(bench::Block<16>, sent_ns, number)
SEGUE_TYPE(bench::Block<64>, sent_ns, number, data)
SEGUE_TYPE(bench::Block<1000>, sent_ns, number, data)
SEGUE_TYPE(bench::Block<1000000>, sent_ns, number, data)
SEGUE_TYPE(bench::Block<100000000>, sent_ns, number, data)
SEGUE_TYPE(bench::Grown, sent_ns, number, data)

namespace bench {
namespace {

namespace link = segue::link;
using segue::task::WriteResult;

segue::Policy policy_for(std::size_t bytes) {
  return {segue::BufferKind::Buffer, bytes > 10'000'000 ? 2U : 16U};
}

segue::SharedMemoryOptions memory_for(std::size_t bytes) {
  segue::SharedMemoryOptions options;
  options.prefault = std::max(options.prefault, bytes * 4);
  return options;
}

template <class T>
class SegueWriter : public Writer {
 public:
  bool connect(const End& end) {
    auto memory = link::SharedMemory::create(memory_for(end.bytes));
    if (!memory) require(std::move(memory.error()));
    memory_ = std::move(*memory);
    source_ = std::make_unique<Source<T>>();
    prime(end.bytes);
    auto endpoint = connect_writer(*memory_, end.socket, source_->output, policy_for(end.bytes));
    if (!endpoint) require(std::move(endpoint.error()));
    endpoint_ = std::move(*endpoint);
    return true;
  }

 protected:
  virtual void prime(std::size_t) {}
  segue::task::OutputPort<T>& output() { return source_->output; }

  /// Writes in place, in the memory that the reader reads.
  bool publish(std::uint64_t number) {
    auto loan = output().loan();
    if (!loan) return false;
    loan->number = number;
    loan->sent_ns = clock_ns();
    return output().publish(std::move(loan)) == WriteResult::Written;
  }

 private:
  std::shared_ptr<link::SharedMemory> memory_;
  std::unique_ptr<Source<T>> source_;
  std::shared_ptr<link::SharedEndpoint> endpoint_;
};

template <class T>
class LoanWriter final : public SegueWriter<T> {
 public:
  bool send(std::uint64_t number) override { return this->publish(number); }
};

template <class T>
class CopyWriter final : public SegueWriter<T> {
 public:
  bool send(std::uint64_t number) override {
    sample_->number = number;
    sample_->sent_ns = clock_ns();
    return this->output().write(*sample_) == WriteResult::Written;
  }

 private:
  std::unique_ptr<T> sample_ = std::make_unique<T>();
};

class FlatWriter final : public SegueWriter<Grown> {
 public:
  bool send(std::uint64_t number) override { return publish(number); }
  void prime(std::size_t bytes) override {
    output().prime({0, 0, std::vector<std::uint8_t>(bytes - sizeof(Stamp))});
  }
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

template <class T>
void read_samples(const End& end, const segue::Activity& activity = {}) {
  auto memory = link::SharedMemory::create(memory_for(0));
  if (!memory) require(std::move(memory.error()));
  Bench bench;
  auto& noter = bench.run<Noter<T>>("noter", activity);
  noter.board = &end.board;
  auto endpoint = connect_reader(**memory, end.socket, noter.input, policy_for(end.bytes));
  if (!endpoint) require(std::move(endpoint.error()));
  noter.ended.wait(false, std::memory_order_acquire);  // asleep, so that only the task's thread is measured
}

template <class W>
std::unique_ptr<Writer> connected(const End& end) {
  auto writer = std::make_unique<W>();
  if (!writer->connect(end)) return nullptr;
  return writer;
}

template <std::size_t N>
struct Sized {
  static std::unique_ptr<Writer> open(const End& end, SegueWay way) {
    if (way != SegueWay::Copied) return connected<LoanWriter<Block<N>>>(end);
    return connected<CopyWriter<Block<N>>>(end);
  }
  static void read(const End& end, SegueWay way) {
    segue::Activity activity;
    if (way == SegueWay::Spinning) activity.spin = segue::kLongestSpin;
    read_samples<Block<N>>(end, activity);
  }
};

class Segue final : public Transport {
 public:
  explicit Segue(SegueWay way) : way_(way) {}

  [[nodiscard]] std::string name() const override {
    switch (way_) {
      case SegueWay::Loaned:
        return "segue, loaned";
      case SegueWay::Copied:
        return "segue, written (one copy)";
      case SegueWay::Flat:
        return "segue, a vector inside (flat, two copies)";
      case SegueWay::Spinning:
        return "segue, loaned, reader spins for 10 ms";
    }
    return {};
  }

  [[nodiscard]] bool carries(std::size_t bytes) const override {
    return bytes == 16 || bytes == 64 || bytes == 1000 || bytes == 1'000'000 || bytes == 100'000'000;
  }

  std::unique_ptr<Writer> open(const End& end) override {
    if (way_ == SegueWay::Flat) return connected<FlatWriter>(end);
    switch (end.bytes) {
      case 16:
        return Sized<16>::open(end, way_);
      case 64:
        return Sized<64>::open(end, way_);
      case 1000:
        return Sized<1000>::open(end, way_);
      case 1'000'000:
        return Sized<1'000'000>::open(end, way_);
      default:
        return Sized<100'000'000>::open(end, way_);
    }
  }

  void read(const End& end) override {
    if (way_ == SegueWay::Flat) return read_samples<Grown>(end);
    switch (end.bytes) {
      case 16:
        return Sized<16>::read(end, way_);
      case 64:
        return Sized<64>::read(end, way_);
      case 1000:
        return Sized<1000>::read(end, way_);
      case 1'000'000:
        return Sized<1'000'000>::read(end, way_);
      default:
        return Sized<100'000'000>::read(end, way_);
    }
  }

 private:
  SegueWay way_;
};

}  // namespace

std::unique_ptr<Transport> make_segue(SegueWay way) {
  return std::make_unique<Segue>(way);
}

}  // namespace bench
