// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

#include <string>

namespace segue {

/// What was measured, for people: three significant digits and a unit, "79.7 us", "128 ms", "4.11 s"; whole
/// seconds from 1000 s on. What was configured is written as in files (format_duration()).
std::string format_seconds(double seconds);
std::string format_seconds(Duration duration);

}  // namespace segue
