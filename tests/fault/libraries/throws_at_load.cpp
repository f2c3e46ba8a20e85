// SPDX-License-Identifier: Apache-2.0
//
// A component library whose static initialisation throws: loading it throws, or ends the process.
#include <stdexcept>

namespace {

struct Thrower {
  Thrower() {
    if (true) throw std::runtime_error("thrown while the library was loaded");
  }
};
const Thrower thrower;

}  // namespace
