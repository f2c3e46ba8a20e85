// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/draw/gantt.hpp>
#include <segue/mission/history.hpp>
#include <segue/mission/program.hpp>

#include <string>

namespace segue::draw {

/// A run of a state machine as drawings show it: a node for each execution of a leaf. Each waited for the
/// outcome of the leaf before it. The chain of nodes that the run was as long for goes through the last to
/// end of those side by side. Sequential are all leaves one after the other. `end` is for what has not ended.
Gantt gantt_of(const mission::Program& program, const mission::History& history,
               const mission::Outcome& outcome, TimePoint begin, TimePoint end);

}  // namespace segue::draw
