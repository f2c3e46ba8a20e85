// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace segue::testing {

/// For thread sanitizer. Cyclone DDS is not compiled for it, so it sees the memory that Cyclone's calls of
/// the C library touch, but not the atomic operations by which Cyclone's threads agree. This hides what
/// Cyclone calls back, too: after changes there, look at the reports without it, which should be about
/// Cyclone's own memory and about freeing what its threads have counted down.
inline constexpr const char* kCycloneSuppressions = "race:libddsc.so\n";

}  // namespace segue::testing
