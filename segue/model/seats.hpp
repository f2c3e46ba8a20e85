// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/network.hpp>

#include <map>

namespace segue::model {

/// The process of each task that has one; tasks of the runtime's own process are left out. Of a task with
/// several seats the first counts. Linear in the size of the network. Pure.
std::map<TaskId, DeploymentKey> seats_of(const Network& network);

}  // namespace segue::model
