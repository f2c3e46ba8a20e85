// SPDX-License-Identifier: Apache-2.0
#include "bench_chain.hpp"

#include <chrono>
#include <cstdint>
#include <utility>

namespace segue::cli {

namespace {

/// More relays at 1 kHz overload a machine with two cores.
constexpr std::size_t kManyRelays = 60;

bool is_exchanged(const ChainOptions& options, std::size_t relay) {
  switch (options.exchange) {
    case Exchange::None:
      return false;
    case Exchange::SecondHalf:
      return relay >= options.relays / 2;
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

model::Task make_producer(const ChainOptions& options) {
  model::Task task = make_task("producer", "bench::Producer");
  task.properties = type::Value::map({{"size", std::uint64_t{options.bytes}}});
  std::optional<Duration> period = options.period;
  if (!period && options.relays > kManyRelays) period = std::chrono::milliseconds(20);
  if (period) task.activity = Activity{Trigger::Periodic, *period, {}, 0, {}, {}, false};
  return task;
}

/// A measured chain drops samples that come too fast, so that its latencies include no queue.
model::Connection connect(const model::Task& from, const model::Task& to, const ChainOptions& options) {
  model::Connection connection;
  connection.from = {from.id, "out"};
  connection.to = {to.id, "in"};
  if (options.record == 0) connection.policy = {BufferKind::Buffer, 64};
  return connection;
}

/// `index`: of the task in the chain. Where samples are timed, both ends are here, so that one clock tells.
bool is_there(const ChainOptions& options, std::size_t index) {
  if (options.transport != BenchTransport::Remote) return false;
  const bool is_relay = index > 0 && index <= options.relays;
  switch (options.placement) {
    case ChainPlacement::All:
      return true;
    case ChainPlacement::Relays:
      return is_relay;
    default:
      return is_relay && index % 2 == 1;
  }
}

void deploy(model::Network& network, const ChainOptions& options) {
  const std::size_t last = network.tasks.size() - 1;
  for (std::size_t i = 0; i < network.tasks.size(); ++i) {
    const model::TaskId& task = network.tasks[i].id;
    const model::Placement placement{task, task.str()};
    if (i == last && options.ends == ChainEnds::OneProcess) {
      network.deployments.front().tasks.push_back(placement);
      return;
    }
    model::Deployment deployment;
    deployment.process = model::ProcessName(task.str());
    deployment.tasks.push_back(placement);
    if (is_there(options, i)) deployment.host = model::HostName(options.host);
    network.deployments.push_back(std::move(deployment));
  }
}

}  // namespace

std::string to_string(BenchTransport transport) {
  switch (transport) {
    case BenchTransport::Local:
      return "local";
    case BenchTransport::SharedMemory:
      return "shm";
    default:
      return "remote";
  }
}

model::Network relay_chain(const ChainOptions& options) {
  model::Network network;
  network.name = model::NetworkName(options.exchange == Exchange::None ? "chain" : "other_chain");
  network.tasks.push_back(make_producer(options));
  for (std::size_t i = 0; i < options.relays; ++i) {
    const std::string stem = is_exchanged(options, i) ? "other_" : "relay_";
    network.tasks.push_back(make_task(stem + std::to_string(i + 1), "bench::Relay"));
  }
  network.tasks.push_back(make_task("consumer", "bench::Consumer"));
  if (options.record > 0)
    network.tasks.back().properties = type::Value::map({{"record", std::uint64_t{options.record}}});
  for (std::size_t i = 1; i < network.tasks.size(); ++i)
    network.connections.push_back(connect(network.tasks[i - 1], network.tasks[i], options));
  if (options.transport != BenchTransport::Local) deploy(network, options);
  return network;
}

}  // namespace segue::cli
