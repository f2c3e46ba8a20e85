// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "transport.hpp"

#include <cstddef>
#include <vector>

/// Samples over a connected stream socket.
namespace bench {

class StreamWriter final : public Writer {
 public:
  StreamWriter(int socket, std::size_t bytes) : socket_(socket), sample_(bytes) {}
  bool send(std::uint64_t number) override;

 private:
  int socket_;
  std::vector<std::byte> sample_;
};

/// Records all samples until the last one; each is copied into the same buffer.
void read_stream(int socket, const End& end);

}  // namespace bench
