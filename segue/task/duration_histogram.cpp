// SPDX-License-Identifier: Apache-2.0
#include <segue/task/duration_histogram.hpp>

#include <algorithm>
#include <cmath>

namespace segue::task {

Duration DurationHistogram::quantile(double share) const {
  const std::uint64_t all = total();
  if (all == 0) return Duration(0);
  const double wanted = std::ceil(std::clamp(share, 0.0, 1.0) * static_cast<double>(all));
  const auto rank = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(wanted));
  std::uint64_t seen = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    seen += counts[bin];
    if (seen >= rank) return below(bin);
  }
  return below(kBins - 1);
}

}  // namespace segue::task
