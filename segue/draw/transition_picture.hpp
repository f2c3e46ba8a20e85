// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/model/transition.hpp>

#include <string>
#include <vector>

namespace segue::draw {

/// The transition over time as a file in SVG: phases as bands, a row for each task, process and connection, a
/// bar for each action, the critical path marked. `durations`: how long each action of the list takes; empty:
/// not known, one step each.
std::string to_svg(const model::Transition& transition, const std::vector<Duration>& durations = {});

/// The partial order as a graph for Graphviz: phases as clusters, the critical path bold.
std::string to_dot(const model::Transition& transition, const std::vector<Duration>& durations = {});

}  // namespace segue::draw
