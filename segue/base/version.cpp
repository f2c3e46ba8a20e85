// SPDX-License-Identifier: Apache-2.0
#include <segue/version.hpp>

namespace segue {

Version version() noexcept {
  return kCompiledVersion;
}

}  // namespace segue
