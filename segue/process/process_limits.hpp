// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/model/network.hpp>

namespace segue::process {

/// Gives this process what its deployment says: environment, limits, processors, scheduler and priority. To
/// be called before there is a second thread: threads inherit them. PermissionDenied, with what to do, where
/// the system does not permit a scheduler (unless the deployment makes it optional: then it is logged) or a
/// limit; InvalidArgument where the computer has none of the processors.
Result<void> apply_to_this_process(const model::Deployment& deployment);

}  // namespace segue::process
