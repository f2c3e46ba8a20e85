// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "transport.hpp"

#include <segue/base/result.hpp>

#include <optional>

namespace bench {

struct HopCase {
  std::size_t bytes = 0;
  std::optional<int> cpu{};
};

/// The time from sending a sample to its reception, one sample at a time, paced so that the reader sleeps
/// before each. An error that says why if the transport failed or lost samples.
segue::Result<Summary> latency(Transport& transport, const HopCase& wanted);

/// Throughput with a few samples in flight: the time per sample, over several batches. An error that says why
/// if the transport failed or lost samples.
segue::Result<Summary> throughput(Transport& transport, const HopCase& wanted);

/// A table of transports, each compared with the first that is measured, which is the floor.
class Comparison {
 public:
  using Experiment = segue::Result<Summary> (*)(Transport&, const HopCase&);
  Comparison(const std::string& title, Experiment experiment, const HopCase& wanted)
      : table_(title), experiment_(experiment), wanted_(wanted) {}
  /// Measures a transport, if it carries samples of that size.
  void add(Transport& transport);
  void print() const;

 private:
  Table table_;
  Experiment experiment_;
  HopCase wanted_;
  std::optional<Summary> floor_;
};

}  // namespace bench
