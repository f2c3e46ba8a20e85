// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

namespace segue {

/// "2026-11-22T01:02:03.456Z": ISO 8601, UTC.
std::string iso_time(std::chrono::system_clock::time_point time);

}  // namespace segue
