// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/place.hpp>

namespace segue::mission {

bool in_parallel(const ParallelBranch* a, const ParallelBranch* b) {
  const auto depth = [](const ParallelBranch* branch) { return branch == nullptr ? 0 : branch->depth; };
  while (depth(a) > depth(b))
    a = a->around.get();
  while (depth(b) > depth(a))
    b = b->around.get();
  for (; a != b; a = a->around.get(), b = b->around.get()) {
    if (a->barrier == b->barrier) return true;  // the branches differ
  }
  return false;
}

}  // namespace segue::mission
