// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>

/// Statistics of measurements in pairs.
namespace segue::cli {

/// Measurements of one task done in two ways under equal conditions, such as with the same seed.
struct MeasuredPair {
  double before = 0;  ///< above 0
  double after = 0;
};

/// The saved share of `before`: 0.2 is a fifth, below 0 is a loss.
struct PairedSaving {
  std::size_t pairs = 0;
  double mean = 0;                   ///< of the savings of the pairs
  std::optional<double> half_width;  ///< of the 95 % confidence interval; nothing below two pairs
};
/// Uses Student's t for paired samples, which also holds for few pairs if their savings are about normally
/// distributed.
PairedSaving paired_saving(std::span<const MeasuredPair> pairs);

/// The 97.5 % quantile of Student's t distribution, to within 0.1 %; `degrees` of freedom, at least one.
double student_t_975(std::size_t degrees);

}  // namespace segue::cli
