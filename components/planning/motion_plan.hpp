// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "arm_scene.hpp"
#include "types.hpp"

namespace planning {

/// Plans to each of the goals, the nearest first, within the budget for each, and answers the cheapest path.
/// NotFound says why there is none, InvalidArgument what makes no sense in the request. Blocks, for seconds
/// where budget and number of goals are large; the same request has the same answer.
///
/// A path keeps a centimetre away from what stands around, and half of that from the rover itself; on the
/// straight lines at its ends it only does not touch anything, and the box that is held or taken is not
/// looked at there: it stands on something.
segue::Result<PlanResult> plan_motion(ArmScene& scene, const PlanRequest& request);

}  // namespace planning
