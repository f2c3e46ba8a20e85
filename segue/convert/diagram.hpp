// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/cdtn/diagram.hpp>
#include <segue/convert/plan.hpp>
#include <segue/mission/action_runner.hpp>

#include <cstddef>
#include <memory>
#include <optional>

namespace segue::convert {

/// The plan as far as it has got, in the words of the mission.
cdtn::Diagram diagram_of(const Plan& plan);

/// Plans about `most` nodes, or as far as the mission can be known; then, where `assumed` is given, on as if
/// actions ended as these runners say, in virtual time. Blocks; the plan is of no use for a run afterwards.
/// An error of the mission itself, which ends it early, is returned; NotFound where an action has no runner.
Result<std::optional<Error>> plan_ahead(Plan& plan, std::size_t most,
                                        const mission::Runners* assumed = nullptr);

}  // namespace segue::convert
