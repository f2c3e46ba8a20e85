// SPDX-License-Identifier: Apache-2.0
#include <segue/base/fnv1a.hpp>
#include <segue/base/varied_duration.hpp>

#include <cmath>

namespace segue {

namespace {

/// splitmix64: a pseudo-random number from any number.
std::uint64_t mixed(std::uint64_t number) {
  number += 0x9E3779B97F4A7C15U;
  number = (number ^ (number >> 30)) * 0xBF58476D1CE4E5B9U;
  number = (number ^ (number >> 27)) * 0x94D049BB133111EBU;
  return number ^ (number >> 31);
}

}  // namespace

Duration varied(Duration expected, std::uint64_t seed, std::uint64_t what, std::uint64_t turn) {
  if (seed == 0) return expected;
  const std::uint64_t number = mixed(mixed(mixed(seed) ^ what) ^ turn);
  const double exponent = static_cast<double>(number >> 11) * 0x1p-53 * 2 - 1;
  const double count = static_cast<double>(expected.count()) * std::exp2(exponent);
  constexpr double kEnd = 0x1p63;
  return count < kEnd ? Duration(static_cast<Duration::rep>(count)) : Duration::max();
}

Duration varied(Duration expected, std::uint64_t seed, std::string_view what, std::uint64_t turn) {
  return varied(expected, seed, fnv1a(what), turn);
}

}  // namespace segue
