// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/action_sites.hpp>
#include <segue/solve/duration_model.hpp>
#include <segue/solve/estimate.hpp>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <queue>
#include <unordered_map>
#include <utility>

namespace segue::solve {

namespace {

using detail::Dice;
using detail::DurationModel;

constexpr std::size_t kPhases = 3;
constexpr int kNoAction = -1;
constexpr auto kQuick = static_cast<double>(model::kQuickAction.count());  // in nanoseconds
/// The fraction of trials below a range, and of those above it.
constexpr double kOutside = 0.02;
/// Relative error that the simulation leaves out: timers, the scheduler, other load.
constexpr double kUnmodelled = 0.03;
constexpr std::size_t kMostSteps = 400'000;
constexpr std::size_t kFewestTrials = 64;

/// Begin and end of each action of one trial in nanoseconds, and the action that it waited for.
struct Run {
  struct Times {
    double begin = 0;
    double end = 0;
    int after = kNoAction;
  };
  std::vector<Times> actions;
  std::array<double, kPhases> phase{};
  double total = 0;
  int last = kNoAction;  ///< the action that ended last
};

/// A transition as indices, for many trials.
class Player {
 public:
  Player(const model::Transition& transition, const std::vector<ActionSite>& sites) {
    const std::size_t count = transition.actions.size();
    std::unordered_map<int, int> positions;
    std::map<std::pair<model::HostName, model::ProcessName>, std::size_t> lanes;
    steps_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const model::Action& action = transition.actions[i];
      const auto position = static_cast<int>(i);
      positions[action.id] = position;
      steps_[i].lane = lanes.try_emplace({sites[i].key.host, sites[i].process}, lanes.size()).first->second;
      const auto phase = static_cast<std::size_t>(action.phase);
      in_phase_.at(phase).push_back(position);
      for (const int id : action.after)
        add_edge(positions, id, position, action.phase, transition);
    }
    lanes_ = lanes.size();
  }

  /// Simulates one execution. Calls `duration` and `wait` once for each action.
  template <class GetDuration, class GetWait>
  Run play(GetDuration duration, GetWait wait) const {
    Run run;
    run.actions.resize(steps_.size());
    for (std::size_t phase = 0; phase < kPhases; ++phase)
      play_phase(phase, run, duration, wait);
    return run;
  }

 private:
  struct Step {
    std::size_t lane = 0;
    int before = 0;          ///< number of predecessors in its phase
    std::vector<int> after;  ///< successors in its phase
  };

  /// Skips edges between phases, which the order of the phases implies.
  void add_edge(const std::unordered_map<int, int>& positions, int id, int position, model::Phase phase,
                const model::Transition& transition) {
    const auto found = positions.find(id);
    if (found == positions.end()) return;
    const auto from = static_cast<std::size_t>(found->second);
    if (transition.actions[from].phase != phase) return;
    steps_[from].after.push_back(position);
    ++steps_[static_cast<std::size_t>(position)].before;
  }

  template <class GetDuration, class GetWait>
  void play_phase(std::size_t phase, Run& run, GetDuration& duration, GetWait& wait) const {
    using Ready = std::pair<double, int>;
    std::priority_queue<Ready, std::vector<Ready>, std::greater<>> ready;
    std::vector<double> lane_free(lanes_, 0);
    std::vector<int> waits_for(steps_.size(), 0);
    const double start = run.total;
    const int released_by = run.last;
    double begin = std::numeric_limits<double>::infinity();
    for (const int position : in_phase_.at(phase)) {
      const auto i = static_cast<std::size_t>(position);
      waits_for[i] = steps_[i].before;
      run.actions[i].after = released_by;
      if (steps_[i].before == 0) ready.emplace(start + wait(), position);
    }
    while (!ready.empty()) {
      const auto [when, position] = ready.top();
      ready.pop();
      const auto i = static_cast<std::size_t>(position);
      Run::Times& times = run.actions[i];
      double& free = lane_free[steps_[i].lane];
      const double length = duration(i);
      times.begin = std::max(when, free);
      times.end = times.begin + length;
      free = times.begin + std::min(length, kQuick);
      begin = std::min(begin, times.begin);
      if (times.end > run.total) run.last = position;
      run.total = std::max(run.total, times.end);
      release(position, run, ready, waits_for, wait);
    }
    run.phase.at(phase) = in_phase_.at(phase).empty() ? 0 : run.total - begin;
  }

  /// A successor is ready at the latest end of its predecessors, which need not be the one popped last.
  template <class Queue, class GetWait>
  void release(int position, Run& run, Queue& ready, std::vector<int>& waits_for, GetWait& wait) const {
    for (const int next : steps_[static_cast<std::size_t>(position)].after) {
      const auto i = static_cast<std::size_t>(next);
      Run::Times& times = run.actions[i];
      const double end = run.actions[static_cast<std::size_t>(position)].end;
      if (end > times.begin) {
        times.begin = end;
        times.after = position;
      }
      if (--waits_for[i] == 0) ready.emplace(times.begin + wait(), next);
    }
  }

  std::vector<Step> steps_;
  std::array<std::vector<int>, kPhases> in_phase_;
  std::size_t lanes_ = 0;
};

Duration as_duration(double nanoseconds) {
  return Duration(static_cast<std::int64_t>(std::llround(std::min(nanoseconds, 9e18))));
}

model::DurationRange range_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto at = [&](double share, double factor) {
    return as_duration(factor *
                       values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))]);
  };
  return {at(kOutside, 1 - kUnmodelled), at(0.5, 1), at(1 - kOutside, 1 + kUnmodelled)};
}

std::size_t trials_for(std::size_t actions, int wanted) {
  const std::size_t affordable = std::max(kMostSteps / std::max<std::size_t>(actions, 1), kFewestTrials);
  return std::min(affordable, static_cast<std::size_t>(std::max(wanted, 1)));
}

std::vector<int> critical_path(const Run& run, const model::Transition& transition) {
  std::vector<int> path;
  for (int at = run.last; at != kNoAction; at = run.actions[static_cast<std::size_t>(at)].after)
    path.push_back(transition.actions[static_cast<std::size_t>(at)].id);
  std::reverse(path.begin(), path.end());
  return path;
}

void find_ranges(Estimate& estimate, const Player& player, DurationModel& model,
                 const std::vector<std::size_t>& sources, const EstimateOptions& options) {
  Dice dice(options.seed);
  std::vector<double> totals;
  std::array<std::vector<double>, kPhases> phases;
  const std::size_t trials = trials_for(sources.size(), options.trials);
  for (std::size_t trial = 0; trial < trials; ++trial) {
    model.begin_trial(dice);
    const Run run = player.play([&](std::size_t i) { return model.draw(sources[i], dice); },
                                [&] { return model.draw_wait(dice); });
    totals.push_back(run.total);
    for (std::size_t phase = 0; phase < kPhases; ++phase)
      phases.at(phase).push_back(run.phase.at(phase));
  }
  estimate.total = range_of(std::move(totals));
  for (std::size_t phase = 0; phase < kPhases; ++phase)
    estimate.phase.at(phase) = range_of(std::move(phases.at(phase)));
}

}  // namespace

Estimate estimate(const model::Network& current, const model::Transition& transition,
                  const model::ActionTimes& times, const EstimateOptions& options) {
  Estimate estimate;
  const auto sites = action_sites(current, transition);
  DurationModel model(times);
  std::vector<std::size_t> sources;
  for (const ActionSite& site : sites) {
    sources.push_back(model.source_of(site.key));
    estimate.typical.push_back(as_duration(model.typical(sources.back())));
    if (!model.is_measured(sources.back())) ++estimate.never_measured;
  }
  const Player player(transition, sites);
  const Run typical = player.play([&](std::size_t i) { return model.typical(sources[i]); },
                                  [&] { return model.typical_wait(); });
  estimate.critical_path = critical_path(typical, transition);
  find_ranges(estimate, player, model, sources, options);
  return estimate;
}

Duration typical_duration(const model::Network& current, const model::Transition& transition,
                          model::Phase phase, const model::ActionTimes& times,
                          const std::vector<std::optional<Duration>>& known) {
  const auto sites = action_sites(current, transition);
  DurationModel model(times);
  std::vector<double> durations(sites.size(), 0);
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const std::size_t source = model.source_of(sites[i].key);
    if (i < known.size() && known[i]) {
      durations[i] = static_cast<double>(known[i]->count());
    } else if (model.is_measured(source)) {
      durations[i] = model.typical(source);
    }
  }
  const Player player(transition, sites);
  const Run run =
      player.play([&](std::size_t i) { return durations[i]; }, [&] { return model.typical_wait(); });
  return as_duration(run.phase.at(static_cast<std::size_t>(phase)));
}

}  // namespace segue::solve
