// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "chain_network.hpp"

namespace segue::cli {

/// In seconds.
struct StepTimes {
  double mean = 0;
  double p99 = 0;
  double worst = 0;
};

/// A connection of a chain, from the write of a sample to its read, or a task's update after that.
struct ChainStep {
  std::string name;
  std::optional<StepTimes> times{};  ///< nothing: it was never measured
  std::string like{};                ///< whose times these are, where not its own
};

/// The times of a chain: from the write of a sample by the first task to the end of the update in which the
/// last one has read what became of it. An update counts as a whole, though it may write before its end.
struct ChainTimes {
  std::vector<ChainStep> steps;
  /// The sum of all steps that were measured; nothing where none was. The 99th percentile and the worst are
  /// bounds: not every step is slow for the same sample.
  [[nodiscard]] std::optional<StepTimes> total() const;
  [[nodiscard]] std::vector<std::string> unmeasured() const;
};

/// The JSON of `task`; null where there is no such task.
using TaskJson = std::function<type::Value(const std::string& id)>;

/// Knows what was measured of what runs.
class MeasuredTimes {
 public:
  MeasuredTimes(const type::Value& status, TaskJson task);

  /// Of a chain of what runs.
  ChainTimes observed(const std::vector<ChainConnection>& chain);
  /// Of a chain of `network`, which will run. What does not run now is expected to take as long as what is
  /// like it: a task as others of its component; a connection as those to the same port of that component,
  /// or else as those that go the same way (in a process, between processes, between computers).
  ChainTimes expected(const std::vector<ChainConnection>& chain, const ChainNetwork& network);

 private:
  struct Measured {
    ChainConnection connection;
    StepTimes times;
  };
  ChainTimes times_of(const std::vector<ChainConnection>& chain, const ChainNetwork* network);
  [[nodiscard]] ChainStep step(const ChainConnection& connection, const ChainNetwork* network) const;
  ChainStep step(const std::string& task, const ChainNetwork* network);
  const std::optional<StepTimes>& update_of(const std::string& task);

  const ChainNetwork runs_;
  const TaskJson task_;
  std::vector<Measured> connections_;
  std::map<std::string, std::optional<StepTimes>> updates_;
};

}  // namespace segue::cli
