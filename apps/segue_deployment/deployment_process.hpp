// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace segue {

/// Runs a deployment process with the descriptors that it inherits, and returns its exit status (both as in
/// process/assignment.hpp). There must be only one thread when it begins.
int deployment_process();

}  // namespace segue
