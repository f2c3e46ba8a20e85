// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/draw/gantt.hpp>
#include <segue/mission/program.hpp>
#include <segue/mission_engine/history.hpp>

#include <string>

namespace segue::draw {

/// The chart of a sequential run of a state machine: a node for each execution of a leaf, which waited for
/// the outcome of the leaf before it. The critical chain contains the last of concurrent states to end. The
/// sequential time is the sum of all leaves. `end` is the end of leaves that have not ended.
Gantt gantt_of(const mission::Program& program, const mission::History& history,
               const mission::Outcome& outcome, TimePoint begin, TimePoint end);

}  // namespace segue::draw
