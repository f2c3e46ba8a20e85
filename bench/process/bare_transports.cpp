// SPDX-License-Identifier: Apache-2.0
// The baselines: mechanisms of the operating system.
#include "transport.hpp"

#include <climits>
#include <cstring>
#include <vector>

#include <linux/futex.h>
#include <sys/socket.h>
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

bool send_all(int socket, const std::byte* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t sent = ::send(socket, bytes, size, MSG_NOSIGNAL);
    if (sent <= 0) return false;
    bytes += sent;
    size -= static_cast<std::size_t>(sent);
  }
  return true;
}

bool receive_all(int socket, std::byte* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t received = ::recv(socket, bytes, size, 0);
    if (received <= 0) return false;
    bytes += received;
    size -= static_cast<std::size_t>(received);
  }
  return true;
}

class SocketWriter final : public Writer {
 public:
  explicit SocketWriter(const End& end) : socket_(end.socket), sample_(end.bytes) {}
  bool send(std::uint64_t number) override {
    const Stamp stamp{clock_ns(), number};
    std::memcpy(sample_.data(), &stamp, sizeof stamp);
    return send_all(socket_, sample_.data(), sample_.size());
  }

 private:
  int socket_;
  std::vector<std::byte> sample_;
};

class UnixSocket final : public Transport {
 public:
  [[nodiscard]] std::string name() const override { return "Unix socket"; }
  [[nodiscard]] bool carries(std::size_t) const override { return true; }
  std::unique_ptr<Writer> open(const End& end) override { return std::make_unique<SocketWriter>(end); }
  void read(const End& end) override {
    std::vector<std::byte> sample(end.bytes);
    Stamp stamp;
    while (stamp.number != kLast && receive_all(end.socket, sample.data(), sample.size())) {
      std::memcpy(&stamp, sample.data(), sizeof stamp);
      end.board.arrive(stamp);
    }
  }
};

}  // namespace

std::unique_ptr<Transport> make_futex() {
  return std::make_unique<Futex>();
}

std::unique_ptr<Transport> make_unix_socket() {
  return std::make_unique<UnixSocket>();
}

}  // namespace bench
