// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>

namespace {

/// Fails while the library is loaded.
struct Unlucky {
  Unlucky() { throw std::runtime_error("no luck today"); }
};
const Unlucky unlucky;

}  // namespace
