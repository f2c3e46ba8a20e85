// SPDX-License-Identifier: Apache-2.0
// The guarantee: what a network does concurrently is what it does sequentially. Random networks with
// conditions, resources, wrong predictions and failures, in a world whose answers depend only on what is
// read, with random durations. SEGUE_CDTN_CASES tries more, SEGUE_CDTN_SEED begins elsewhere. The same
// program with SEGUE_CDTN_FAULTS plants faults into the scheduler and expects to find each.
#include <segue/task_network/concurrent_engine.hpp>
#include <segue/task_network/critical_path.hpp>
#include <segue/task_network/engine_fault.hpp>
#include <segue/task_network/flat_file.hpp>
#include <segue/task_network/sequential.hpp>
#include <support/check_run.hpp>
#include <support/random_task_networks.hpp>
#include <support/sanitizers.hpp>

#include <gmock/gmock.h>

#include <cstdlib>

namespace segue::task_network {
namespace {

/// More than any node of these networks needs.
constexpr std::uint32_t kMostAttempts = 1000;

std::uint64_t setting(const char* name, std::uint64_t fallback) {
  const char* given = std::getenv(name);
  return given == nullptr ? fallback : std::strtoull(given, nullptr, 10);
}

ConcurrentEngineOptions options_of(std::uint64_t seed) {
  ConcurrentEngineOptions options;
  options.log = true;
  options.strict = mix(seed, 1) % 2 == 0;
  options.speculate = mix(seed, 2) % 8 != 0;
  options.workers = mix(seed, 3) % 4 == 0 ? static_cast<std::uint32_t>(mix(seed, 4) % 3 + 1) : 0;
  options.world_copies = mix(seed, 5) % 4 == 0 ? static_cast<std::uint32_t>(mix(seed, 6) % 2 + 1) : 0;
  options.ahead = mix(seed, 9) % 4 == 0 ? static_cast<std::uint32_t>(mix(seed, 10) % 2 + 1) : 0;
  options.least_likelihood = mix(seed, 11) % 4 == 0 ? 0.3 : 0;
  return options;
}

/// Prints the network and the results of its nodes, for whoever looks for a fault.
void show(const TaskNetwork& network, const RunResult& sequential, const RunResult& concurrent) {
  fmt::print("{}", write_flat_network({network, {}}));
  for (std::uint32_t i = 0; i < network.size(); ++i) {
    fmt::print("n{}: {} -> {}, starts at {} s, counts at {} s\n", i,
               static_cast<int>(sequential.nodes[i].status), static_cast<int>(concurrent.nodes[i].status),
               concurrent.nodes[i].started.time_since_epoch() / std::chrono::seconds(1),
               concurrent.nodes[i].committed.time_since_epoch() / std::chrono::seconds(1));
  }
  for (const LogEntry& entry : concurrent.log)
    fmt::print("{} s: n{} {}\n", entry.when.time_since_epoch() / std::chrono::seconds(1), index(entry.node),
               static_cast<int>(entry.kind));
}

/// The difference between the concurrent and the sequential run of that seed, or "".
std::string difference(std::uint64_t seed) {
  ConcurrentEngineOptions options = options_of(seed);
  const bool failures = mix(seed, 7) % 2 == 0;
  // A strict node does not wait for what may fail beside it.
  const Variety variety{failures, failures && options.strict, !failures && !options.strict};
  const RandomNetwork random(seed, variety);
  const TaskNetwork& network = random.network;
  RandomEnvironment reference(network, seed, variety, seed, Pace::Steady);
  const RunResult sequential = run_sequential(network, reference);
  const Order order = derive_order(network);
  if (!failures && mix(seed, 8) % 4 == 0) options.priorities = critical_path_priorities(network, order);
  for (const Pace pace : {Pace::Unsteady, Pace::Steady}) {
    const bool steady = pace == Pace::Steady;
    RandomEnvironment environment(network, seed, variety, steady ? seed : mix(seed, 100), pace);
    ConcurrentEngine engine(network, order, environment, options);
    bool ends = true;
    environment.limit_attempts(kMostAttempts, [&] {
      ends = false;
      engine.stop();
    });
    const RunResult concurrent = engine.run();
    if (!ends) return "it does not end: a node begins again and again";
    RunCheck check(network, sequential, concurrent, options.strict,
                   [&](NodeId acts, NodeId fails) { return network.in_parallel(acts, fails); });
    std::string text = check.difference();
    if (text.empty() && steady && options.priorities.empty()) text = check.slower();
    if (!text.empty() && setting("SEGUE_CDTN_SHOW", 0) != 0) show(network, sequential, concurrent);
    if (!text.empty()) return text;
  }
  return {};
}

#ifndef SEGUE_CDTN_FAULTS

TEST(Equivalence, ConcurrentRunsDoWhatTheSequentialOneDoes) {
  const std::uint64_t first = setting("SEGUE_CDTN_SEED", 1);
  const std::uint64_t cases = setting("SEGUE_CDTN_CASES", kSanitized ? 2'000 : 40'000);
  for (std::uint64_t seed = first; seed < first + cases; ++seed) {
    const std::string text = difference(seed);
    ASSERT_EQ(text, "") << "SEGUE_CDTN_SEED=" << seed;
  }
}

#else

class Planted : public testing::TestWithParam<int> {};

TEST_P(Planted, FaultsOfTheSchedulerAreFound) {
  constexpr std::uint64_t kCases = 20'000;
  planted_fault = static_cast<EngineFault>(GetParam());
  std::uint64_t seed = 1;
  while (seed < kCases && difference(seed).empty())
    ++seed;
  planted_fault = EngineFault::None;
  EXPECT_LT(seed, kCases) << "this fault would go unnoticed";
}

INSTANTIATE_TEST_SUITE_P(All, Planted, testing::Range(1, static_cast<int>(EngineFault::CountsPreempted) + 1));

#endif

}  // namespace
}  // namespace segue::task_network
