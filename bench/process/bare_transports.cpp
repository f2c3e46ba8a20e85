// SPDX-License-Identifier: Apache-2.0
// The baselines: mechanisms of the operating system.
#include "stream.hpp"
#include "transport.hpp"

#include <climits>

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace bench {
namespace {

class FutexWriter final : public Writer {
 public:
  explicit FutexWriter(Board& board) : board_(board) {}
  bool send(std::uint64_t number) override {
    board_.stamp = {clock_ns(), number};
    board_.word.fetch_add(1, std::memory_order_release);
    ::syscall(SYS_futex, &board_.word, FUTEX_WAKE, INT_MAX, nullptr, nullptr, 0);
    return true;
  }

 private:
  Board& board_;
};

class Futex final : public Transport {
 public:
  [[nodiscard]] std::string name() const override { return "floor: bare futex hand-over"; }
  [[nodiscard]] bool carries(std::size_t) const override { return true; }
  std::unique_ptr<Writer> open(const End& end) override { return std::make_unique<FutexWriter>(end.board); }
  void read(const End& end) override {
    Board& board = end.board;
    std::uint32_t seen = 0;
    while (board.stamp.number != kLast) {
      ::syscall(SYS_futex, &board.word, FUTEX_WAIT, seen, nullptr, nullptr, 0);
      const std::uint32_t now = board.word.load(std::memory_order_acquire);
      if (now == seen) continue;
      seen = now;
      board.arrive(board.stamp);
    }
  }
};

class UnixSocket final : public Transport {
 public:
  [[nodiscard]] std::string name() const override { return "Unix socket"; }
  [[nodiscard]] bool carries(std::size_t) const override { return true; }
  std::unique_ptr<Writer> open(const End& end) override {
    return std::make_unique<StreamWriter>(end.socket, end.bytes);
  }
  void read(const End& end) override { read_stream(end.socket, end); }
};

}  // namespace

std::unique_ptr<Transport> make_futex() {
  return std::make_unique<Futex>();
}

std::unique_ptr<Transport> make_unix_socket() {
  return std::make_unique<UnixSocket>();
}

}  // namespace bench
