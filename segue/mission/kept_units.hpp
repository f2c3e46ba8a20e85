// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/mission.hpp>

#include <optional>
#include <string>
#include <string_view>

namespace segue::mission {

/// The name of the resource of units that are kept after the action that blocked them has ended: "arm
/// (kept)".
std::string kept_name(std::string_view resource);
bool is_kept_name(std::string_view resource);
/// The resource of which the use keeps or releases units, or refers to those that are kept.
std::optional<std::string> kept_resource(const ResourceUse& use);

/// Expresses what actions keep and release by units that come and go, which both engines take in program
/// order: an action that keeps units of "arm" moves them to "arm (kept)" when it ends as expected, and one
/// that releases them moves them back. Adds those resources. Requires that validate() has found no errors.
void move_kept_units(Mission& mission);

}  // namespace segue::mission
