// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/cdtn/environment.hpp>
#include <segue/cdtn/task_network.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace segue::cdtn {

/// What a node does in a trial, where that is not success as predicted.
struct Trial {
  OutcomeId outcome = kSuccess;
  std::optional<std::vector<Literal>> effects;  ///< what happens instead of the declared ones
};

/// Nodes that only take time: the expected duration each, and end as their trial says.
class SimulatedEnvironment final : public Environment {
 public:
  /// `trials` by node; nodes beyond succeed. With a seed, durations vary between half and twice the expected
  /// one, the same for the same seed, node and attempt; 0: exactly as expected. `network` must outlive this.
  explicit SimulatedEnvironment(const TaskNetwork& network, std::vector<Trial> trials = {},
                                std::uint64_t seed = 0)
      : network_(network), trials_(std::move(trials)), seed_(seed) {}

  void start(NodeContext& context, Completions& completions) override;
  void cancel(NodeId node, std::uint32_t attempt, Completions& completions) override;

 private:
  [[nodiscard]] Duration duration(NodeId node, std::uint32_t attempt) const;
  [[nodiscard]] ReportPtr report(NodeId node) const;

  const TaskNetwork& network_;
  std::vector<Trial> trials_;
  std::uint64_t seed_;
};

}  // namespace segue::cdtn
