// SPDX-License-Identifier: Apache-2.0
#include <segue/base/rounded_text.hpp>

#include <array>
#include <cmath>
#include <cstdio>

namespace segue {

namespace {

/// From here on a number is rounded to 1000.
constexpr double kNextUnit = 999.5;

std::string with_unit(double number, const char* format, const char* unit) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, number);
  return std::string(text.data()) + ' ' + unit;
}

}  // namespace

std::string format_seconds(double seconds) {
  const double size = std::abs(seconds);
  if (size * 1e6 < kNextUnit) return with_unit(seconds * 1e6, "%.3g", "us");
  if (size * 1e3 < kNextUnit) return with_unit(seconds * 1e3, "%.3g", "ms");
  return with_unit(seconds, size < kNextUnit ? "%.3g" : "%.0f", "s");
}

std::string format_seconds(Duration duration) {
  return format_seconds(std::chrono::duration<double>(duration).count());
}

std::string format_quantity(double number, std::string_view unit) {
  constexpr std::array<const char*, 5> kPrefixes = {"", "k", "M", "G", "T"};
  std::size_t prefix = 0;
  for (; number >= kNextUnit && prefix + 1 < kPrefixes.size(); ++prefix)
    number /= 1000;
  return with_unit(number, number < kNextUnit ? "%.3g" : "%.0f", kPrefixes.at(prefix)) + std::string(unit);
}

}  // namespace segue
