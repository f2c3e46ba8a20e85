// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace segue::mission {

/// What becomes of potentially irreversible actions that were running when a run was interrupted, once it is
/// resumed (RunJournal::resume): it is refused; they go on where they are, and it is refused if that is not
/// possible; they are executed again; are taken as ended as expected, with default outputs; or as aborted.
enum class UnderWay : std::uint8_t { Refuse, GoOn, Again, Skip, Abort };

}  // namespace segue::mission
