// SPDX-License-Identifier: Apache-2.0
#include "priority.hpp"

#include <segue/task_network/critical_path.hpp>

namespace segue::task_network {

std::vector<std::uint64_t> choose_priorities(const TaskNetwork& network, const Order& order,
                                             std::vector<Trial> trials, ConcurrentEngineOptions options,
                                             std::stop_token stop) {
  options.clock = ClockKind::Virtual;
  options.log = false;
  SimulatedEnvironment environment(network, std::move(trials));
  const auto simulate = [&](std::vector<std::uint64_t> priorities) {
    options.priorities = std::move(priorities);
    ConcurrentEngine engine(network, order, environment, options);
    const std::stop_callback end(stop, [&] { engine.stop(); });
    return engine.run();
  };
  const RunResult in_order = simulate({});
  const RunResult by_path = simulate(critical_path_priorities(network, order));
  const bool better = by_path.done() && in_order.done() && by_path.makespan < in_order.makespan;
  return better ? critical_path_priorities(network, order) : std::vector<std::uint64_t>{};
}

}  // namespace segue::task_network
