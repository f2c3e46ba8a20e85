// SPDX-License-Identifier: Apache-2.0
// How short runs of plans become whose actions take different times and share resources: the plans of a
// folder with DOMAIN/PROBLEM/{domain,problem}.pddl and plans, once with list scheduling (the longest
// remaining path first) over each order that Segue derives, and once as Segue chooses priorities. Figures are
// of virtual time.
#include <segue/pddl/pddl.hpp>
#include <segue/task_network/concurrent_engine.hpp>
#include <segue/task_network/critical_path.hpp>
#include <segue/task_network/order.hpp>
#include <segue/task_network/priority.hpp>
#include <segue/task_network/simulated_environment.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace {

using namespace segue;
using namespace segue::task_network;

/// FNV-1a.
std::uint64_t hash_of(const std::string& text) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : text)
    hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return hash;
}

/// The plan with actions that take between 1 and 10 s, by their names and arguments, and one of `units` units
/// of what carries out actions of their kind; its order does not matter.
TaskNetwork with_times(const TaskNetwork& plan, std::uint32_t units) {
  TaskNetwork network;
  network.facts = plan.facts;
  network.initial_world = plan.initial_world;
  network.goal = plan.goal;
  for (std::uint32_t i = 0; i < plan.size(); ++i) {
    const std::string& name = plan.name_of(NodeId{i});
    NodeSpec spec;
    spec.name = name;
    spec.iteration = plan[NodeId{i}].iteration;
    spec.duration = std::chrono::seconds(1 + hash_of(name) % 10);
    for (const Access& access : plan.accesses(NodeId{i})) {
      if (access.reads) spec.preconditions.push_back({access.fact, access.needed});
      if (access.writes) spec.effects.push_back({access.fact, access.value});
    }
    const ResourceId crew = network.resources.intern("process:" + name.substr(0, name.find_first_of(" (")));
    network.resources[crew].count = units;
    network.resources[crew].commutes = true;
    spec.claims = {{crew}};
    network.append(spec);
  }
  return network;
}

double seconds(Duration time) {
  return std::chrono::duration<double>(time).count();
}

Duration simulated(const TaskNetwork& network, const Order& order, std::vector<std::uint64_t> priorities) {
  SimulatedEnvironment environment(network);
  ConcurrentEngineOptions options;
  options.priorities = std::move(priorities);
  const RunResult result = ConcurrentEngine(network, order, environment, options).run();
  if (!result.done()) fmt::print(stderr, "a run failed\n");
  return result.makespan;
}

/// No run is shorter: the critical path of the order, and for each resource the time of its users, shared by
/// its units.
Duration least_time(const TaskNetwork& network, const Order& order) {
  std::vector<Duration> busy(network.resources.size());
  for (std::uint32_t i = 0; i < network.size(); ++i) {
    for (const Claim& claim : network.claims(NodeId{i}))
      busy[index(claim.resource)] += network[NodeId{i}].duration;
  }
  Duration least = critical_path(network, order).length;
  for (std::uint32_t i = 0; i < busy.size(); ++i)
    least = std::max(least, busy[i] / network.resources[ResourceId{i}].count);
  return least;
}

/// The geometric mean of what is added.
class GeometricMean {
 public:
  void add(double value) {
    sum_ += std::log(value);
    ++count_;
  }
  [[nodiscard]] double value() const { return std::exp(sum_ / std::max(count_, 1)); }
  [[nodiscard]] int count() const { return count_; }

 private:
  double sum_ = 0;
  int count_ = 0;
};

std::vector<std::filesystem::path> plans_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> plans;
  for (const auto& file : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string name = file.path().filename();
    if (name == "plan" || name.starts_with("plan.")) plans.push_back(file.path());
  }
  std::ranges::sort(plans);
  return plans;
}

void measure(const std::vector<std::filesystem::path>& plans, std::uint32_t units) {
  GeometricMean gain;
  GeometricMean bound;
  std::map<std::string, GeometricMean> by_domain;
  int worse = 0;
  int shortest = 0;
  Duration search{};
  for (const auto& file : plans) {
    Diagnostics diagnostics;
    const auto folder = file.parent_path();
    const auto plan = pddl::load_pddl(folder / "domain.pddl", folder / "problem.pddl", file, diagnostics);
    if (!plan) {
      fmt::print(stderr, "{}: {}\n", file.string(), to_string(diagnostics));
      continue;
    }
    const TaskNetwork network = with_times(plan->network, units);
    Duration listed = Duration::max();
    Duration chosen = Duration::max();
    Duration least = Duration::max();
    for (const OrderRule rule : {OrderRule::Epoch, OrderRule::Goal}) {
      const Order order = derive_order(network, rule);
      listed = std::min(listed, simulated(network, order, critical_path_priorities(network, order)));
      const auto began = std::chrono::steady_clock::now();
      auto priorities = choose_priorities(network, order, {}, {});
      search += std::chrono::steady_clock::now() - began;
      chosen = std::min(chosen, simulated(network, order, std::move(priorities)));
      least = std::min(least, least_time(network, order));
    }
    gain.add(seconds(listed) / seconds(chosen));
    bound.add(seconds(listed) / seconds(least));
    by_domain[folder.parent_path().filename()].add(seconds(listed) / seconds(chosen));
    worse += chosen > listed ? 1 : 0;
    shortest += chosen == least ? 1 : 0;
  }
  for (const auto& [domain, mean] : by_domain)
    fmt::print("{:<28} {:>3} plans  {:.3f}\n", domain, mean.count(), mean.value());
  fmt::print(
      "{} of each: {} plans, list scheduling takes {:.3f} of the time chosen, and at most {:.3f} of the "
      "optimum; "
      "{} plans become longer, {} are optimal; {:.2f} s of search for each order\n",
      units, gain.count(), gain.value(), bound.value(), worse, shortest,
      seconds(search) / std::max(1, 2 * gain.count()));
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    fmt::print(stderr,
               "usage: schedule_bench FOLDER\nFOLDER has DOMAIN/PROBLEM/{{domain.pddl,problem.pddl,plan}}\n");
    return 2;
  }
  const auto plans = plans_in(arguments[1]);
  for (const std::uint32_t units : {1U, 2U, 3U, 4U})
    measure(plans, units);
  return 0;
}
