// SPDX-License-Identifier: Apache-2.0
#include "priority.hpp"

#include <segue/task_network/critical_path.hpp>

#include <algorithm>
#include <random>
#include <utility>

namespace segue::task_network {

namespace {

using Priorities = std::vector<std::uint64_t>;

/// Of larger networks, only the two rules are compared.
constexpr std::uint32_t kMostSearched = 3000;
/// How many runs in a row are no shorter before the best one is disturbed by a further hundredth.
constexpr int kPatience = 10;

class PrioritySearch {
 public:
  PrioritySearch(const TaskNetwork& network, const Order& order, std::vector<Trial> trials,
                 ConcurrentEngineOptions options, std::stop_token stop, std::uint64_t most)
      : network_(network),
        order_(order),
        environment_(network, std::move(trials)),
        options_(std::move(options)),
        stop_(std::move(stop)),
        left_(most) {
    options_.clock = ClockKind::Virtual;
    options_.log = false;
  }

  Priorities run() {
    const RunResult in_order = simulate({});
    if (!in_order.done()) return {};
    keep(in_order, {});
    const Duration shortest = critical_path(network_, order_, in_order).length;
    try_with(critical_path_priorities(network_, order_));
    if (network_.size() > kMostSearched) return best_;
    for (int in_vain = 0; best_time_ > shortest && left_ > network_.size() && !stop_.stop_requested();
         ++in_vain) {
      if (try_with(disturbed(1 + in_vain / kPatience))) in_vain = 0;
    }
    return best_;
  }

 private:
  RunResult simulate(Priorities priorities) {
    left_ -= std::min<std::uint64_t>(left_, network_.size());
    options_.priorities = std::move(priorities);
    ConcurrentEngine engine(network_, order_, environment_, options_);
    const std::stop_callback end(stop_, [&] { engine.stop(); });
    return engine.run();
  }

  /// True if the run is shorter than all before.
  bool try_with(Priorities priorities) {
    const RunResult result = simulate(priorities);
    if (!result.done() || result.makespan >= best_time_) return false;
    keep(result, std::move(priorities));
    return true;
  }

  void keep(const RunResult& result, Priorities priorities) {
    best_ = std::move(priorities);
    best_time_ = result.makespan;
    starts_.clear();
    for (const NodeResult& node : result.nodes)
      starts_.push_back(node.started.time_since_epoch());
  }

  /// The times at which nodes of the best run begin, changed at random by some hundredths of the whole
  /// time.
  Priorities disturbed(int hundredths) {
    std::uniform_real_distribution<double> change(-1, 1);
    const double range = static_cast<double>(best_time_.count()) * hundredths / 100;
    Priorities priorities;
    for (const Duration start : starts_) {
      const double moved = static_cast<double>(start.count()) + change(random_) * range;
      priorities.push_back(static_cast<std::uint64_t>(std::max(moved, 0.0)));
    }
    return priorities;
  }

  const TaskNetwork& network_;
  const Order& order_;
  SimulatedEnvironment environment_;
  ConcurrentEngineOptions options_;
  const std::stop_token stop_;
  std::uint64_t left_;
  std::mt19937_64 random_{1};
  Duration best_time_{};
  Priorities best_;
  std::vector<Duration> starts_;  ///< of the best run
};

}  // namespace

Priorities choose_priorities(const TaskNetwork& network, const Order& order, std::vector<Trial> trials,
                             ConcurrentEngineOptions options, std::stop_token stop, std::uint64_t most) {
  return PrioritySearch(network, order, std::move(trials), std::move(options), std::move(stop), most).run();
}

}  // namespace segue::task_network
