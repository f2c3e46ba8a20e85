// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace segue {

/// How the execution of an action, or of a node of a task network, may be treated. Irreversible: its effects
/// cannot be undone, so it starts only when it is certain to be needed. Pure: it changes nothing outside the
/// plan, so it may run speculatively on a predicted world, be repeated and be discarded. Sensing: as Pure,
/// but it observes the real world and never runs on a predicted one.
enum class ActionClass : std::uint8_t { Irreversible, Pure, Sensing };

}  // namespace segue
