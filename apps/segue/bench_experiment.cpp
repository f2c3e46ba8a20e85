// SPDX-License-Identifier: Apache-2.0
#include "bench_experiment.hpp"

#include <chrono>

namespace segue::cli {

namespace {

constexpr const char* kProducer = "producer";
constexpr const char* kConsumer = "consumer";

/// More relays at 1 kHz overload a machine with two cores.
constexpr std::size_t kManyRelays = 60;

bool is_exchanged(const ChainOptions& options, std::size_t relay) {
  switch (options.exchange) {
    case Exchange::None:
      return false;
    case Exchange::One:
      return relay == options.relays / 2;
    case Exchange::All:
      return true;
    case Exchange::Block:
      return relay >= options.relays / 4 && relay < options.relays / 4 + (options.relays + 1) / 2;
    default:
      return relay % 2 == 0;
  }
}

model::Task make_task(const std::string& id, const std::string& component) {
  model::Task task;
  task.id = model::TaskId(id);
  task.component = model::ComponentName(component);
  return task;
}

model::Connection connect(const model::Task& from, const model::Task& to) {
  model::Connection connection;
  connection.from = {from.id, "fixed_out"};
  connection.to = {to.id, "fixed_in"};
  connection.policy = {BufferKind::Buffer, 64};
  return connection;
}

model::Deployment own_process(const model::Task& task) {
  model::Deployment deployment;
  deployment.process = model::ProcessName(task.id.str());
  deployment.tasks.push_back({task.id, task.id.str()});
  return deployment;
}

/// One placement's measurements.
class ChainRun {
 public:
  using Report = std::function<bool(const Measurement&)>;

  ChainRun(BenchRobot& robot, Placement placement, std::size_t repeat, const Report& report)
      : robot_(robot), placement_(placement), repeat_(repeat), report_(report) {}

  [[nodiscard]] bool stopped() const { return stopped_; }

  /// Up and down, the last time up.
  Result<void> bring_up(std::size_t relays) {
    for (std::size_t i = 0; i < repeat_ && !stopped_; ++i) {
      if (i > 0) {
        if (auto done = measure("E1.2", relays, {}); !done) return done;
      }
      if (auto done = measure("E1.1", relays, chain(relays, Exchange::None)); !done) return done;
      if (auto done = robot_.wait_for_samples(); !done) return done;
    }
    return {};
  }

  Result<void> tear_down(std::size_t relays) {
    return stopped_ ? Result<void>{} : measure("E1.2", relays, {});
  }

  /// Exchanges the relays, and then changes them back.
  Result<void> exchange(const std::string& name, std::size_t relays, Exchange which, bool gaps = false) {
    for (std::size_t i = 0; i < 2 * repeat_ && !stopped_; ++i) {
      const auto network = chain(relays, i % 2 == 0 ? which : Exchange::None);
      if (auto done = robot_.watch_gap(); !done) return done;
      if (auto done = robot_.wait_for_samples(); !done) return done;
      if (auto done = measure(name, relays, network); !done) return done;
      if (auto done = robot_.wait_for_samples(); !done) return done;
      if (!gaps) continue;
      const auto gap = robot_.longest_gap();
      if (!gap) return gap.error();
      tell({"E2.3 gap", placement_, relays, *gap});
    }
    return {};
  }

 private:
  [[nodiscard]] model::Network chain(std::size_t relays, Exchange exchange) const {
    return relay_chain({relays, exchange, placement_});
  }

  Result<void> measure(const std::string& name, std::size_t relays, const model::Network& network) {
    const auto seconds = robot_.switch_to(network);
    if (!seconds) return seconds.error();
    tell({name, placement_, relays, *seconds});
    return {};
  }

  void tell(const Measurement& measurement) { stopped_ = !report_(measurement) || stopped_; }

  BenchRobot& robot_;
  Placement placement_;
  std::size_t repeat_;
  const Report& report_;
  bool stopped_ = false;
};

Result<void> run_size(ChainRun& run, std::size_t relays) {
  if (auto done = run.bring_up(relays); !done) return done;
  if (auto done = run.exchange("E2.1", relays, Exchange::One); !done) return done;
  if (auto done = run.exchange("E2.2", relays, Exchange::All); !done) return done;
  if (auto done = run.exchange("E2.3 best", relays, Exchange::Block); !done) return done;
  if (auto done = run.exchange("E2.3 worst", relays, Exchange::EverySecond, true); !done) return done;
  return run.tear_down(relays);
}

}  // namespace

std::string to_string(Placement placement) {
  return placement == Placement::OneProcess ? "one process" : "a process for each task";
}

model::Network relay_chain(const ChainOptions& options) {
  model::Network network;
  network.name = model::NetworkName("chain");
  network.tasks.push_back(make_task(kProducer, "bench::Producer"));
  if (options.relays > kManyRelays) {
    network.tasks.back().activity =
        Activity{Trigger::Periodic, std::chrono::milliseconds(20), {}, 0, {}, {}, false};
  }
  for (std::size_t i = 0; i < options.relays; ++i) {
    const std::string stem = is_exchanged(options, i) ? "other_" : "relay_";
    network.tasks.push_back(make_task(stem + std::to_string(i + 1), "bench::Relay"));
  }
  network.tasks.push_back(make_task(kConsumer, "bench::Consumer"));
  for (std::size_t i = 1; i < network.tasks.size(); ++i)
    network.connections.push_back(connect(network.tasks[i - 1], network.tasks[i]));
  if (options.placement == Placement::OneProcess) return network;
  for (const model::Task& task : network.tasks)
    network.deployments.push_back(own_process(task));
  return network;
}

const std::vector<Experiment>& experiments() {
  static const std::vector<Experiment> all = {
      {"E1.1", "Bringing up a chain of relays"},
      {"E1.2", "Taking down a chain of relays"},
      {"E2.1", "Exchange of one relay of a running chain"},
      {"E2.2", "Exchange of all relays of a running chain"},
      {"E2.3 best", "Exchange of half of the relays, neighbours of each other"},
      {"E2.3 worst", "Exchange of half of the relays, every second one"},
      {"E2.3 gap", "Longest pause between samples while every second relay is exchanged"}};
  return all;
}

Result<void> run_experiments(BenchRobot& robot, Placement placement, const std::vector<std::size_t>& sizes,
                             std::size_t repeat, const std::function<bool(const Measurement&)>& report) {
  ChainRun run(robot, placement, repeat, report);
  for (const std::size_t relays : sizes) {
    if (run.stopped()) break;
    if (auto done = run_size(run, relays); !done) return done;
  }
  return {};
}

}  // namespace segue::cli
