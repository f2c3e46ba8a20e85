// SPDX-License-Identifier: Apache-2.0
#include <segue/journal/entries.hpp>
#include <segue/solve/action_sites.hpp>
#include <segue/solve/estimate.hpp>
#include <segue/solve/solve.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

/// Compares estimates with simulated executions on a robot whose components take random times.
namespace segue::solve {
namespace {

using model::ActionKind;
using model::Phase;

double seconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

class Robot {
 public:
  explicit Robot(std::uint64_t seed) : random_(seed) {
    for (int component = 0; component < kComponents; ++component) {
      for (std::size_t kind = 0; kind < model::kActionKindNames.size(); ++kind)
        usual_[component][kind] = usual_duration(static_cast<ActionKind>(kind));
      noise_[component] = std::uniform_real_distribution<>(0.05, 0.4)(random_);
    }
  }

  /// A random network: some of twenty tasks in up to four processes, connected at random.
  model::Network network() {
    model::Network created;
    for (int i = 0; i < 4; ++i) {
      created.deployments.emplace_back();
      created.deployments.back().process = model::ProcessName("p" + std::to_string(i));
    }
    for (int i = 0; i < 20; ++i) {
      if (chance(0.4)) continue;
      model::Task task;
      task.id = model::TaskId("t" + std::to_string(i));
      task.component = model::ComponentName("demo::C" + std::to_string(i % kComponents));
      if (chance(0.3)) task.properties.as_map().set("speed", below(3));
      if (i < 16)
        created.deployments[static_cast<std::size_t>(i % 4)].tasks.push_back({task.id, task.id.str()});
      created.tasks.push_back(std::move(task));
    }
    std::erase_if(created.deployments, [](const auto& process) { return process.tasks.empty(); });
    for (int i = 0; i < 15 && created.tasks.size() > 1; ++i) {
      const auto& from =
          created.tasks[static_cast<std::size_t>(below(static_cast<int>(created.tasks.size())))];
      const auto& to = created.tasks[static_cast<std::size_t>(below(static_cast<int>(created.tasks.size())))];
      const model::Connection connection{{from.id, "out"}, {to.id, "in"}, {}, {}};
      const auto& connections = created.connections;
      if (from.id != to.id &&
          std::find(connections.begin(), connections.end(), connection) == connections.end())
        created.connections.push_back(connection);
    }
    return created;
  }

  /// Simulates an execution and its journal entry: a ready action begins after a short delay, and the three
  /// phases are sequential.
  journal::TransitionEntry execute(const model::Transition& transition,
                                   const std::vector<ActionSite>& sites) {
    journal::TransitionEntry entry;
    double phase_begin = 0;
    double now = 0;
    std::vector<double> end(transition.actions.size() + 1);
    for (const Phase phase : {Phase::Prepare, Phase::Commit, Phase::Retire}) {
      phase_begin = now;
      for (std::size_t i = 0; i < transition.actions.size(); ++i) {
        const model::Action& action = transition.actions[i];
        if (action.phase != phase) continue;
        double ready = phase_begin;
        for (const int before : action.after)
          ready = std::max(ready, end[static_cast<std::size_t>(before)]);
        const double waited = std::uniform_real_distribution<>(20e-6, 400e-6)(random_);
        const double took = duration_of(sites[i].key);
        end[static_cast<std::size_t>(action.id)] = ready + waited + took;
        now = std::max(now, ready + waited + took);
        entry.actions.push_back({action.id,
                                 action.kind,
                                 phase,
                                 action.label(),
                                 sites[i].key.component,
                                 sites[i].key.host,
                                 sites[i].process,
                                 nanoseconds(ready + waited),
                                 nanoseconds(waited),
                                 nanoseconds(took),
                                 nanoseconds(ready + waited + took),
                                 journal::kDone,
                                 {}});
      }
      if (phase == Phase::Commit) entry.commit = nanoseconds(now - phase_begin);
    }
    entry.total = nanoseconds(now);
    return entry;
  }

 private:
  static constexpr int kComponents = 12;

  static Duration nanoseconds(double value) { return Duration(static_cast<std::int64_t>(value * 1e9)); }
  bool chance(double probability) { return std::bernoulli_distribution(probability)(random_); }
  int below(int count) { return std::uniform_int_distribution<>(0, count - 1)(random_); }

  /// From devices that take seconds to actions that take microseconds.
  double usual_duration(ActionKind kind) {
    const auto between = [&](double low, double high) {
      return std::exp(std::uniform_real_distribution<>(std::log(low), std::log(high))(random_));
    };
    switch (kind) {
      case ActionKind::Configure:
        return between(1e-3, 3);
      case ActionKind::Start:
      case ActionKind::Stop:
        return between(1e-3, 0.2);
      case ActionKind::Deploy:
        return between(0.05, 0.5);
      default:
        return between(0.3e-3, 20e-3);
    }
  }

  /// One in fifty actions takes much longer.
  double duration_of(const model::ActionKey& key) {
    const std::size_t number = std::hash<std::string>{}(key.component) % kComponents;
    const int component =
        key.component.starts_with("demo::C") ? std::stoi(key.component.substr(7)) : static_cast<int>(number);
    const double noise = std::normal_distribution<>(0, noise_[component])(random_);
    const double outlier = chance(0.02) ? std::uniform_real_distribution<>(2, 6)(random_) : 1;
    return usual_[component][static_cast<std::size_t>(key.kind)] * std::exp(noise) * outlier;
  }

  std::mt19937_64 random_;
  double usual_[kComponents][model::kActionKindNames.size()]{};
  double noise_[kComponents]{};
};

void learn(model::ActionTimes& times, const journal::TransitionEntry& entry) {
  const journal::DurationSamples samples = journal::duration_samples(entry);
  for (const auto& [key, duration] : samples.actions)
    times.actions[key].add(duration);
  for (const Duration wait : samples.waits)
    times.waits.add(wait);
}

/// The accuracy of the estimates of one robot's transitions.
struct Score {
  int asked = 0;
  int total_within = 0;
  int commit_within = 0;
  std::vector<double> total_width;  ///< high / low
  std::vector<double> commit_width;
};

void score_robot(std::uint64_t seed, Score& score) {
  Robot robot(seed);
  model::ActionTimes times;
  model::Network current;
  const auto go = [&](bool asked) {
    const model::Network target = robot.network();
    const auto transition = diff(current, target, {});
    ASSERT_TRUE(transition);
    const auto sites = action_sites(current, *transition);
    const auto entry = robot.execute(*transition, sites);
    if (asked) {
      const Estimate found = estimate(current, *transition, times);
      ++score.asked;
      score.total_within += found.total.contains(entry.total) ? 1 : 0;
      score.commit_within += found.of(Phase::Commit).contains(entry.commit) ? 1 : 0;
      score.total_width.push_back(seconds(found.total.high) / seconds(found.total.low));
      if (found.of(Phase::Commit).low > Duration(0))
        score.commit_width.push_back(seconds(found.of(Phase::Commit).high) /
                                     seconds(found.of(Phase::Commit).low));
    } else {
      learn(times, entry);
    }
    current = target;
  };
  for (int i = 0; i < 10; ++i)
    go(false);
  for (int i = 0; i < 20; ++i)
    go(true);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[values.size() / 2];
}

TEST(EstimateCalibration, AfterTenTransitionsNineOfTenNewOnesLieWithinTheirRange) {
  Score score;
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    score_robot(seed, score);
  const double asked = score.asked;
  RecordProperty("total_within_percent", static_cast<int>(100 * score.total_within / asked));
  std::printf("of %d: total within %.1f %%, commit within %.1f %%; median high/low %.2f and %.2f\n",
              score.asked, 100 * score.total_within / asked, 100 * score.commit_within / asked,
              median(score.total_width), median(score.commit_width));
  EXPECT_GE(score.total_within, 0.9 * asked);
  EXPECT_GE(score.commit_within, 0.9 * asked);
  // Very wide ranges would always be right, so the width is checked as well.
  EXPECT_LE(median(score.total_width), 4);
  EXPECT_LE(median(score.commit_width), 4);
}

}  // namespace
}  // namespace segue::solve
