// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/convert/mission_plan.hpp>
#include <segue/draw/diagram.hpp>

namespace segue::draw {

/// The diagram of the plan as far as it has been made, in the terms of the mission.
Diagram diagram_of(const convert::MissionPlan& plan);

}  // namespace segue::draw
