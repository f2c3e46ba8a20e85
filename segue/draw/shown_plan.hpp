// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/draw/diagram.hpp>
#include <segue/mission/program.hpp>
#include <segue/type/value.hpp>

namespace segue::draw {

/// The most states that are shown.
inline constexpr std::size_t kMostShownStates = 5000;

/// The plan of a mission, for programs that show how it runs: {"mission", "states", "complete" (else there
/// are more states than are shown), "nodes"}. "states": parents before their children, libraries as if they
/// were written where they are used; each
/// {"path" ("": the mission), "in" (the path of its container; none: the mission), "title", "kind", "action",
/// "library", "start" (a path), "next": a list of {"outcome", and "to" (a path) or "returns" (an outcome of
/// its container)}, "flows": of containers, a list of {"from", "to" (paths), "what"}, "units": which units of
/// the robot it takes when it begins, a list of {"name", "count"}; absent where it takes none}. "nodes": of
/// `concurrent`, null without it: in program order, each {"name", "in", "role", "after": what it waits for,
/// as far as it is not implied: a list of {"node" (its position), "kind",
/// "subject" (of a condition: the outcome that leads here), "because", "holds_start"}, "units": of which
/// resources it needs units to begin: a list of {"resource", "observed" (the robot shows how many there
/// are)}}.
type::Value shown_plan(const mission::Program& program, const Diagram* concurrent);

}  // namespace segue::draw
