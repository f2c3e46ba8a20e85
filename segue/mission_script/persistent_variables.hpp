// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/mission.hpp>

namespace segue::mission {

/// Whether executions of the action see what the one before of the same state has left, as far as its script
/// says so: it names `persistent_variables`, or assigns to an attribute of `self`. What modules do that it
/// imports is not seen. False where it is no script, or its file cannot be read. Reads that file.
[[nodiscard]] bool uses_persistent_variables(const Mission& mission, const Action& action);

}  // namespace segue::mission
