// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

#include <string>

namespace segue {

/// A measured duration for people to read: three significant digits and a unit, "79.7 us", "128 ms", "4.11
/// s"; whole seconds from 1000 s on. Configured durations are written as in files (format_duration()).
std::string format_seconds(double seconds);
std::string format_seconds(Duration duration);

}  // namespace segue
