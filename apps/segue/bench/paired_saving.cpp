// SPDX-License-Identifier: Apache-2.0
#include "paired_saving.hpp"

#include <array>
#include <cmath>

namespace segue::cli {

double student_t_975(std::size_t degrees) {
  static constexpr std::array<double, 10> kFew = {12.706, 4.303, 3.182, 2.776, 2.571,
                                                  2.447,  2.365, 2.306, 2.262, 2.228};
  if (degrees <= kFew.size()) return kFew[degrees - 1];
  // The expansion by Cornish and Fisher (Abramowitz and Stegun, 26.7.5).
  constexpr double kZ = 1.959964;  // of the normal distribution
  const auto power = [](int exponent) { return std::pow(kZ, exponent); };
  const auto n = static_cast<double>(degrees);
  return kZ + (power(3) + kZ) / (4 * n) + (5 * power(5) + 16 * power(3) + 3 * kZ) / (96 * n * n) +
         (3 * power(7) + 19 * power(5) + 17 * power(3) - 15 * kZ) / (384 * n * n * n);
}

PairedSaving paired_saving(std::span<const MeasuredPair> pairs) {
  PairedSaving saving;
  saving.pairs = pairs.size();
  if (pairs.empty()) return saving;
  const auto count = static_cast<double>(pairs.size());
  for (const MeasuredPair& pair : pairs)
    saving.mean += (1 - pair.after / pair.before) / count;
  if (pairs.size() < 2) return saving;
  double variance = 0;
  for (const MeasuredPair& pair : pairs)
    variance += std::pow(1 - pair.after / pair.before - saving.mean, 2) / (count - 1);
  saving.half_width = student_t_975(pairs.size() - 1) * std::sqrt(variance / count);
  return saving;
}

}  // namespace segue::cli
