// SPDX-License-Identifier: Apache-2.0
// The accuracy of predictions: random robots of stand-ins, whose actions take different times by component,
// execute ten random transitions; then the fraction of twenty new transitions with a duration in the
// predicted range.
#include "support/robot.hpp"

#include <segue/runtime/runtime.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace {

using namespace bench;
using namespace segue;

constexpr int kRobots = 3;
constexpr int kLearnt = 10;
constexpr int kAsked = 20;
constexpr int kComponents = 8;
constexpr int kTasks = 16;

using Random = std::mt19937_64;

int below(Random& random, int count) {
  return std::uniform_int_distribution<>(0, count - 1)(random);
}

/// Times from a millisecond up, over several orders of magnitude.
std::string random_durations(Random& random) {
  const auto between = [&](double low, double high) {
    const double drawn = std::exp(std::uniform_real_distribution<>(std::log(low), std::log(high))(random));
    return std::to_string(static_cast<int>(drawn * 1000)) + "us";
  };
  std::string text = "stand_ins:\n  default: {rate: 0}\n";
  for (int i = 0; i < kComponents; ++i) {
    text += "  demo::C" + std::to_string(i) + ": {configure: " + between(1, 200) +
            ", start: " + between(1, 40) + ", stop: " + between(1, 40) + ", cleanup: " + between(1, 20) +
            ", rate: 0}\n";
  }
  return text;
}

model::Network random_network(Random& random, int number) {
  model::Network made;
  made.name = model::NetworkName("random" + std::to_string(number));
  for (int i = 0; i < 3; ++i) {
    made.deployments.emplace_back();
    made.deployments.back().process = model::ProcessName("p" + std::to_string(i));
  }
  for (int i = 0; i < kTasks; ++i) {
    if (below(random, 5) < 2) continue;
    model::Task task;
    task.id = model::TaskId("t" + std::to_string(i));
    task.component = model::ComponentName("demo::C" + std::to_string(i % kComponents));
    if (below(random, 3) == 0) task.properties.as_map().set("speed", below(random, 3));
    if (i % 4 != 3)
      made.deployments[static_cast<std::size_t>(i % 4)].tasks.push_back({task.id, task.id.str()});
    made.tasks.push_back(std::move(task));
  }
  std::erase_if(made.deployments, [](const auto& process) { return process.tasks.empty(); });
  const int count = static_cast<int>(made.tasks.size());
  for (int i = 0; i < 12 && count > 1; ++i) {
    const auto& from = made.tasks[static_cast<std::size_t>(below(random, count))];
    const auto& to = made.tasks[static_cast<std::size_t>(below(random, count))];
    const model::Connection wire{{from.id, "out"}, {to.id, "in"}, {}, {}};
    const auto& wires = made.connections;
    if (from.id != to.id && std::find(wires.begin(), wires.end(), wire) == wires.end())
      made.connections.push_back(wire);
  }
  return made;
}

struct Score {
  int asked = 0;
  int total = 0;
  int commit = 0;
  std::vector<double> width;  ///< of the total: high / low
};

/// The predicted quantity: the time to the end of the last action.
Duration total_of(const runtime::SwitchResult& result) {
  Duration total{0};
  for (const auto& record : result.actions)
    total = std::max(total, record.started + record.duration);
  return total;
}

void measure_robot(std::uint64_t seed, runtime::TaskPlacement placement, Score& score) {
  Random random(seed);
  const Scratch scratch;
  runtime::EmbeddedOptions options;
  options.stand_in = true;
  options.stand_ins = scratch.write("durations.yaml", random_durations(random));
  options.placement = placement;
  options.log_level = LogLevel::Error;
  options.journal = true;
  const auto file = scratch.write("robot.yaml", "robot: segue-estimate-bench\nhosts: {localhost: local}\n");
  options.journal_file = file.parent_path() / "journal.sqlite";
  auto robot = open(file, options);
  for (int i = 0; i < kLearnt + kAsked; ++i) {
    const auto result = robot.runtime().switch_to(random_network(random, i));
    done(result);
    if (i < kLearnt || !result.predicted) continue;
    ++score.asked;
    score.total += result.predicted->total.contains(total_of(result)) ? 1 : 0;
    score.commit += result.predicted->commit.contains(result.commit) ? 1 : 0;
    score.width.push_back(std::chrono::duration<double>(result.predicted->total.high) /
                          std::chrono::duration<double>(result.predicted->total.low));
    if (std::getenv("SEGUE_BENCH_DETAILS") != nullptr) {
      const auto ms = [](Duration time) { return std::chrono::duration<double, std::milli>(time).count(); };
      std::printf("  total %8.2f in %8.2f .. %8.2f   commit %8.2f in %8.2f .. %8.2f\n", ms(total_of(result)),
                  ms(result.predicted->total.low), ms(result.predicted->total.high), ms(result.commit),
                  ms(result.predicted->commit.low), ms(result.predicted->commit.high));
    }
  }
  done(robot.shut_down());
}

void measure(runtime::TaskPlacement placement, const char* name) {
  Score score;
  for (std::uint64_t seed = 1; seed <= kRobots; ++seed)
    measure_robot(seed, placement, score);
  std::sort(score.width.begin(), score.width.end());
  std::printf(
      "%s: of %d transitions the total of %.0f %% and the commit of %.0f %% were within their range; median "
      "high/low %.2f\n",
      name, score.asked, 100.0 * score.total / score.asked, 100.0 * score.commit / score.asked,
      score.width.empty() ? 0 : score.width[score.width.size() / 2]);
}

}  // namespace

int main() {
  ::setenv("SEGUE_DEPLOYMENT", SEGUE_BENCH_DEPLOYMENT, 0);
  std::printf("\nPredictions after %d transitions, of transitions never made before\n", kLearnt);
  measure(runtime::TaskPlacement::InProcess, "one process");
  measure(runtime::TaskPlacement::Processes, "four processes");
}
