// SPDX-License-Identifier: Apache-2.0
#include "joining.hpp"

#include <unistd.h>

namespace bench {

void wait_for_the_other(const End& end) {
  char byte = 0;
  [[maybe_unused]] const ssize_t closed = ::read(end.socket, &byte, 1);
}

std::string topic_name(std::size_t number) {
  return "topic" + std::to_string(number);
}

}  // namespace bench
