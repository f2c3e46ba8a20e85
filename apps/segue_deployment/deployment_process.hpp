// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/sample_link/shared_memory.hpp>

#include <memory>

namespace segue {

/// The parts of a deployment process that are made before it is known which process it will be.
struct PreparedProcess {
  std::shared_ptr<sample_link::SharedMemory> memory;  ///< of the usual size; null: none yet
};

/// Makes the parts that take longest between a fork and the first answer: shared memory of the usual size,
/// prefaulted, and the memory of the tasks' log. Starts no thread. A part that fails is left out, and
/// deployment_process() says why.
PreparedProcess prepare_deployment_process();

/// Runs a deployment process with the descriptors that it inherits, and returns its exit status (both as in
/// process_server/assignment.hpp). There must be only one thread when it begins.
int deployment_process(PreparedProcess prepared);

}  // namespace segue
