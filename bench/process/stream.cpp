// SPDX-License-Identifier: Apache-2.0
#include "stream.hpp"

#include <cstring>

#include <sys/socket.h>

namespace bench {
namespace {

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

}  // namespace

bool StreamWriter::send(std::uint64_t number) {
  const Stamp stamp{clock_ns(), number};
  std::memcpy(sample_.data(), &stamp, sizeof stamp);
  return send_all(socket_, sample_.data(), sample_.size());
}

void read_stream(int socket, const End& end) {
  std::vector<std::byte> sample(end.bytes);
  Stamp stamp;
  while (stamp.number != kLast && receive_all(socket, sample.data(), sample.size())) {
    std::memcpy(&stamp, sample.data(), sizeof stamp);
    end.board.arrive(stamp);
  }
}

}  // namespace bench
