// SPDX-License-Identifier: Apache-2.0
// The twelve transitions of the Artemis rover with its processes dealt out to one, two and three hosts, while
// the network between runtime and hosts delays everything. How often a phase waits for an answer follows from
// how much longer it takes for a delay.
//
//   remote_switch_bench [HOSTS...]      default: 1 2 3
#include "support/hosts.hpp"
#include "support/measure.hpp"

#include <segue/runtime/runtime.hpp>

#include <hosts/test_network.hpp>

#include <fcntl.h>
#include <sched.h>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

namespace {

using namespace bench;
using namespace segue;
using segue::testing::TestNetwork;
using std::chrono::milliseconds;

constexpr const char* kArtemis = SEGUE_SOURCE_DIR "/examples/04_artemis/robot.yaml";
constexpr const char* kRuntime = "runtime";
const std::vector<std::string> kHosts = {"a", "b", "c"};

/// Each transition once.
constexpr std::array kWalk = {
    "search_explore",     "goal_navigation",    "search_explore", "manipulation",    "search_explore",
    "manipulator_teleop", "goal_navigation",    "manipulation",   "goal_navigation", "manipulator_teleop",
    "manipulation",       "manipulator_teleop", "search_explore"};

/// A condition of the measurement: delays in one direction (there and back takes twice as long), and how many
/// times.
struct Condition {
  milliseconds delay;
  int walks;
};
constexpr std::array kConditions = {Condition{milliseconds(0), 3}, Condition{milliseconds(1), 3},
                                    Condition{milliseconds(20), 1}};

/// Name spaces of networks for the runtime and the hosts, joined by a network that delays what it is told to.
/// This process is in that of the runtime from then on. Without permission for that, hosts are reached by
/// loopback.
class DelayedNetwork {
 public:
  /// To be called while this process has one thread.
  DelayedNetwork() {
    if (!TestNetwork::obstacle().empty()) return;
    std::vector<std::string> stations = {kRuntime};
    stations.insert(stations.end(), kHosts.begin(), kHosts.end());
    network_ = std::make_unique<TestNetwork>(stations);
    const int space = ::open((std::string("/run/netns/") + kRuntime).c_str(), O_RDONLY | O_CLOEXEC);
    if (space < 0 || ::setns(space, CLONE_NEWNET) != 0) {
      std::perror("cannot enter the name space of the runtime");
      std::exit(1);
    }
    ::close(space);
  }

  [[nodiscard]] bool can_delay() const { return network_ != nullptr; }
  void delay(milliseconds time) {
    if (network_) network_->say("delay " + std::to_string(time.count()) + "ms");
  }
  [[nodiscard]] std::vector<Site> sites(std::size_t count) const {
    std::vector<Site> sites;
    for (std::size_t i = 0; i < count; ++i) {
      sites.push_back({kHosts[i]});
      if (!network_) continue;
      sites.back().address = network_->address(kHosts[i]);
      sites.back().launcher = TestNetwork::launcher(kHosts[i]);
    }
    return sites;
  }

 private:
  std::unique_ptr<TestNetwork> network_;
};

/// The measured parts of a switch: from the request to the result, then its phases.
constexpr std::array kParts = {"all", "prepare", "commit", "retire"};
using Times = std::array<Duration, kParts.size()>;

/// The times of each transition of the walk.
std::vector<Times> walk(runtime::Runtime& runtime) {
  std::vector<Times> times;
  for (std::size_t i = 1; i < kWalk.size(); ++i) {
    const TimePoint begin = RealClock::instance().now();
    const auto result = runtime.switch_to(model::NetworkName(kWalk[i]));
    done(result);
    times.push_back({RealClock::instance().now() - begin, result.prepare, result.commit, result.retire});
  }
  return times;
}

/// The median times of each transition over several walks.
std::vector<Times> walks(runtime::Runtime& runtime, int count) {
  std::vector<std::vector<Times>> each;
  for (int i = 0; i < count; ++i)
    each.push_back(walk(runtime));
  std::vector<Times> medians = each.front();
  for (std::size_t transition = 0; transition < medians.size(); ++transition) {
    for (std::size_t part = 0; part < kParts.size(); ++part) {
      std::vector<Duration> values;
      for (const auto& one : each)
        values.push_back(one[transition][part]);
      medians[transition][part] = summarise(std::move(values)).median;
    }
  }
  return medians;
}

double ms(Duration time) {
  return std::chrono::duration<double, std::milli>(time).count();
}

/// The median of the transitions, and the largest, for each part; `value(transition, part)`.
template <class Value>
void print_row(const std::string& title, std::size_t transitions, const Value& value) {
  std::printf("  %-28s", title.c_str());
  for (std::size_t part = 0; part < kParts.size(); ++part) {
    std::vector<double> values;
    for (std::size_t i = 0; i < transitions; ++i)
      values.push_back(value(i, part));
    std::sort(values.begin(), values.end());
    std::printf("%9.1f /%7.1f", values[(values.size() - 1) / 2], values.back());
  }
  std::printf("\n");
  std::fflush(stdout);
}

void print_round_trips(const std::vector<Times>& without, const std::vector<Times>& with,
                       milliseconds delay) {
  const auto trips = [&](std::size_t i, std::size_t part) {
    return ms(with[i][part] - without[i][part]) / ms(2 * delay);
  };
  print_row("round trips, from " + std::to_string(delay.count()) + " ms", without.size(), trips);
}

void measure(DelayedNetwork& network, std::size_t count) {
  const Hosts hosts(network.sites(count));
  const Scratch scratch;
  const auto file = runtime::deal_out(kArtemis, hosts.over_tcp(), scratch.path() / "robot");
  if (!file) {
    std::fprintf(stderr, "%s\n", to_string(file.error()).c_str());
    std::exit(1);
  }
  runtime::EmbeddedOptions options;
  options.stand_in = true;
  options.placement = runtime::TaskPlacement::Processes;
  options.log_level = LogLevel::Error;
  auto robot = open(*file, options);
  done(robot.switch_to(kWalk.front()));
  walk(robot.runtime());  // the zygotes have started, files are known
  std::printf("\nArtemis on %zu host%s, twelve transitions: median / largest, ms\n  %-28s", count,
              count == 1 ? "" : "s", "delay in each direction");
  for (const char* part : kParts)
    std::printf("%18s", part);
  std::printf("\n");
  std::vector<Times> without;
  for (const auto& [delay, repeats] : kConditions) {
    if (delay > milliseconds(0) && !network.can_delay()) break;
    network.delay(delay);
    const auto times = walks(robot.runtime(), repeats);
    print_row(std::to_string(delay.count()) + " ms", times.size(),
              [&](std::size_t i, std::size_t part) { return ms(times[i][part]); });
    if (delay == milliseconds(0)) without = times;
    if (delay == kConditions.back().delay) print_round_trips(without, times, delay);
  }
  network.delay(milliseconds(0));
  done(robot.shut_down());
}

}  // namespace

int main(int argc, char** argv) {
  set_log_level(LogLevel::Error);
  DelayedNetwork network;
  if (!network.can_delay())
    std::printf("left out: delays, since they need name spaces of networks: %s\n",
                TestNetwork::obstacle().c_str());
  std::vector<std::size_t> counts;
  for (int i = 1; i < argc; ++i)
    counts.push_back(std::strtoul(argv[i], nullptr, 10));
  if (counts.empty()) counts = {1, 2, 3};
  for (const std::size_t count : counts) {
    if (count < 1 || count > kHosts.size()) {
      std::fprintf(stderr, "usage: remote_switch_bench [1] [2] [3]\n");
      return 2;
    }
    measure(network, count);
  }
}
