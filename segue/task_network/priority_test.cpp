// SPDX-License-Identifier: Apache-2.0
#include <segue/task_network/critical_path.hpp>
#include <segue/task_network/priority.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <random>

namespace segue::task_network {
namespace {

/// Eight jobs of six actions each, which follow each other, at random ones of five machines.
TaskNetwork job_shop(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  TaskNetwork network;
  for (int job = 0; job < 8; ++job) {
    std::optional<Literal> before;
    for (int step = 0; step < 6; ++step) {
      NodeSpec spec;
      spec.duration = std::chrono::seconds(1 + random() % 9);
      const ResourceId machine = network.resources.intern("machine " + std::to_string(random() % 5));
      network.resources[machine].commutes = true;
      spec.claims = {{machine}};
      if (before) spec.preconditions = {*before};
      before =
          Literal{*network.facts.intern("done(" + std::to_string(job) + "," + std::to_string(step) + ")")};
      spec.effects = {*before};
      network.append(spec);
    }
  }
  return network;
}

Duration makespan(const TaskNetwork& network, std::vector<std::uint64_t> priorities) {
  const Order order = derive_order(network);
  SimulatedEnvironment environment(network);
  ConcurrentEngineOptions options;
  options.priorities = std::move(priorities);
  return ConcurrentEngine(network, order, environment, options).run().makespan;
}

TEST(Priorities, AreNeverWorseThanEitherRuleAndOftenBetter) {
  int better = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const TaskNetwork network = job_shop(seed);
    const Order order = derive_order(network);
    const Duration rules =
        std::min(makespan(network, {}), makespan(network, critical_path_priorities(network, order)));
    const Duration chosen = makespan(network, choose_priorities(network, order, {}, {}, {}, 50'000));
    EXPECT_LE(chosen, rules) << seed;
    better += chosen < rules ? 1 : 0;
  }
  EXPECT_GE(better, 5);
}

TEST(Priorities, AreTheSameEachTime) {
  const TaskNetwork network = job_shop(3);
  const Order order = derive_order(network);
  EXPECT_EQ(choose_priorities(network, order, {}, {}, {}, 50'000),
            choose_priorities(network, order, {}, {}, {}, 50'000));
}

}  // namespace
}  // namespace segue::task_network
