// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace segue::mission {

/// "fetch/grasp" from the ids of states, the innermost first; in what is at the path `around`.
[[nodiscard]] std::string state_path(const std::vector<const std::string*>& ids, std::string around = {});

}  // namespace segue::mission
