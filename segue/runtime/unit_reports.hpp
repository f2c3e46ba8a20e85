// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/journal/stored_units.hpp>
#include <segue/runtime/leases.hpp>
#include <segue/type/value.hpp>

#include <cstdint>

namespace segue::runtime::detail {

/// Takes what the holder of a lease says of the robot's units ("units" of control::RobotService::report()),
/// and removes it. Blocks until it is on the disk. InvalidState where that lease is not held any more,
/// InvalidArgument; and as journal::StoredUnits.
Result<void> take_units(type::Value& doing, std::uint64_t lease, const Leases& leases,
                        journal::StoredUnits& units);

}  // namespace segue::runtime::detail
