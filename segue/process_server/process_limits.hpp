// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/process_server/launch.hpp>

namespace segue::process_server {

/// Applies peers, environment, limits, processors, scheduler and priority of a launch to this process. To be
/// called before there is a second thread, since threads inherit them. PermissionDenied, with advice, where
/// the system does not permit a limit or the scheduler (a scheduler that is optional is only logged);
/// InvalidArgument where the computer has none of the processors.
Result<void> apply_to_this_process(const Launch& launch);

}  // namespace segue::process_server
