// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

#include <string>
#include <string_view>

namespace segue {

/// A measured duration for people to read: three significant digits and a unit, "79.7 us", "128 ms", "4.11
/// s"; whole seconds from 1000 s on. Configured durations are written as in files (format_duration()).
std::string format_seconds(double seconds);
std::string format_seconds(Duration duration);

/// Three digits and the unit, with a decimal prefix: "31.2 kB", "100 Hz", "25.3 GB". Requires that it is not
/// negative.
std::string format_quantity(double number, std::string_view unit);

}  // namespace segue
