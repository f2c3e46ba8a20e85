// SPDX-License-Identifier: Apache-2.0
#include "joining.hpp"
#include "transport.hpp"

namespace bench {

std::unique_ptr<Transport> make_cyclone() {
  return nullptr;
}

std::unique_ptr<Joining> make_cyclone_joining() {
  return nullptr;
}

}  // namespace bench
