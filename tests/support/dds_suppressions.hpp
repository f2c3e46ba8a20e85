// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace segue::testing {

/// For thread sanitizer. Cyclone DDS and Fast DDS are not compiled for it, so it sees the memory that their
/// calls of the C library touch, but not the atomic operations by which their threads agree, and not the
/// calls with a time-out by which Fast DDS locks. This hides what they call back, too: after changes there,
/// look at the reports without it, which should be about their own memory and locks, and about freeing what
/// their threads have counted down.
inline constexpr const char* kDdsSuppressions =
    "race:libddsc.so\nrace:libfastrtps.so\nmutex:libfastrtps.so\ndeadlock:libfastrtps.so\n";

}  // namespace segue::testing
