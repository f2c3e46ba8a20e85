// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace segue::mission {

/// One state of a barrier, in one execution of that barrier.
struct ParallelBranch {
  std::shared_ptr<const ParallelBranch> around;  ///< the branch that contains the barrier; null: none
  std::uint64_t barrier = 0;                     ///< number of the execution of the barrier
  std::uint32_t child = 0;                       ///< of the barrier
  std::uint32_t depth = 1;                       ///< this one and those around it
};

/// Where an execution of an action stands in the sequential order of a concurrent mission. Immutable, so any
/// thread may read it.
struct Place {
  std::uint64_t position = 0;  ///< counted from 1; 0: before all actions
  std::shared_ptr<const ParallelBranch> branch;
  std::string who;  ///< for messages
};

/// Whether they lie in different branches of one execution of a barrier, so that neither comes first.
[[nodiscard]] bool in_parallel(const ParallelBranch* a, const ParallelBranch* b);

}  // namespace segue::mission
