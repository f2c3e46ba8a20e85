// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace segue::mission {

/// How RunJournal::resume() treats potentially irreversible actions that were running when the run was
/// interrupted: refuse; go on with them where they are, and refuse if that is not possible; execute them
/// again; take them as ended as expected, with default outputs; or as aborted.
enum class UnderWay : std::uint8_t { Refuse, GoOn, Again, Skip, Abort };

}  // namespace segue::mission
