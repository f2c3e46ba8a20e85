// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "transport.hpp"

#include <optional>

namespace bench {

struct HopCase {
  std::size_t bytes = 0;
  std::optional<int> cpu{};
};

/// One sample at a time, paced so that the reader sleeps before each: from the moment before it is sent to
/// the moment when the reader has it. Nothing where the transport failed or lost samples.
std::optional<Summary> latency(Transport& transport, const HopCase& wanted);

/// As many as possible, a few under way: how long each takes, over several batches.
std::optional<Summary> throughput(Transport& transport, const HopCase& wanted);

}  // namespace bench
