// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_network/environment.hpp>
#include <segue/task_network/task_network.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace segue::task_network {

/// The simulated behaviour of a node; by default it succeeds with its declared effects.
struct Trial {
  OutcomeId outcome = kSuccess;
  std::optional<std::vector<Literal>> effects;  ///< what happens instead of the declared ones
};

/// Simulates nodes: each takes its expected duration and ends as its trial says.
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

}  // namespace segue::task_network
