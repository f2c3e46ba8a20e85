// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace segue {

/// Everything of a deployment process between its first line and its last, with the descriptors of
/// deploy/assignment.hpp. Answers the exit status (deploy/deployment_exit.hpp). Must begin with one thread.
int deployment_process();

}  // namespace segue
