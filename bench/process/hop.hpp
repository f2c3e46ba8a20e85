// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "transport.hpp"

#include <optional>

namespace bench {

struct HopCase {
  std::size_t bytes = 0;
  std::optional<int> cpu{};
};

/// The time from sending a sample to its reception, one sample at a time, paced so that the reader sleeps
/// before each. Nothing if the transport failed or lost samples.
std::optional<Summary> latency(Transport& transport, const HopCase& wanted);

/// Throughput with a few samples in flight: the time per sample, over several batches.
std::optional<Summary> throughput(Transport& transport, const HopCase& wanted);

}  // namespace bench
