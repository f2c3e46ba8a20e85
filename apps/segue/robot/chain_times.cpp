// SPDX-License-Identifier: Apache-2.0
#include "chain_times.hpp"

#include <algorithm>
#include <utility>

#include "../output.hpp"

namespace segue::cli {

namespace {

using type::Value;

/// Those of several like ones: the mean of all, and the longest of the others.
std::optional<StepTimes> together(const std::vector<StepTimes>& all) {
  if (all.empty()) return std::nullopt;
  StepTimes times;
  for (const StepTimes& one : all) {
    times.mean += one.mean / static_cast<double>(all.size());
    times.p99 = std::max(times.p99, one.p99);
    times.worst = std::max(times.worst, one.worst);
  }
  return times;
}

std::string way_of(const ChainConnection& connection, const ChainNetwork& network) {
  const ChainTask* from = network.task(connection.from.task);
  const ChainTask* to = network.task(connection.to.task);
  if (from == nullptr || to == nullptr) return {};
  if (from->host != to->host) return "between computers";
  return from->process == to->process ? "in a process" : "between processes";
}

std::string component_of(const std::string& task, const ChainNetwork& network) {
  const ChainTask* found = network.task(task);
  return found == nullptr ? std::string() : found->component;
}

}  // namespace

std::optional<StepTimes> ChainTimes::total() const {
  std::optional<StepTimes> sum;
  for (const ChainStep& step : steps) {
    if (!step.times) continue;
    const StepTimes before = sum.value_or(StepTimes());
    sum = {before.mean + step.times->mean, before.p99 + step.times->p99, before.worst + step.times->worst};
  }
  return sum;
}

std::vector<std::string> ChainTimes::unmeasured() const {
  std::vector<std::string> names;
  for (const ChainStep& step : steps) {
    if (!step.times) names.push_back(step.name);
  }
  return names;
}

MeasuredTimes::MeasuredTimes(const Value& status, TaskJson task) : runs_(status), task_(std::move(task)) {
  for (const Value& connection : list_at(status, "connections")) {
    const auto from = runs_.find(printable_at(connection, "from"));
    const auto to = runs_.find(printable_at(connection, "to"));
    if (!from || !to || number_at(connection, "measured") == 0) continue;
    connections_.push_back(
        {{*from, *to},
         {number_at(connection, "latency_us") * 1e-6, number_at(connection, "latency_p99_us") * 1e-6,
          number_at(connection, "latency_worst_us") * 1e-6}});
  }
}

ChainTimes MeasuredTimes::observed(const std::vector<ChainConnection>& chain) {
  return times_of(chain, nullptr);
}

ChainTimes MeasuredTimes::expected(const std::vector<ChainConnection>& chain, const ChainNetwork& network) {
  return times_of(chain, &network);
}

ChainTimes MeasuredTimes::times_of(const std::vector<ChainConnection>& chain, const ChainNetwork* network) {
  ChainTimes times;
  for (const ChainConnection& connection : chain) {
    times.steps.push_back(step(connection, network));
    times.steps.push_back(step(connection.to.task, network));
  }
  return times;
}

ChainStep MeasuredTimes::step(const ChainConnection& connection, const ChainNetwork* network) const {
  const std::string name = to_string(connection);
  const auto those = [&](const auto& fits) {
    std::vector<StepTimes> all;
    for (const Measured& one : connections_) {
      if (fits(one.connection)) all.push_back(one.times);
    }
    return together(all);
  };
  auto own = those([&](const ChainConnection& one) { return one == connection; });
  if (own || network == nullptr) return {name, own};
  const std::string component = component_of(connection.to.task, *network);
  auto same_port = those([&](const ChainConnection& one) {
    return one.to.port == connection.to.port && component_of(one.to.task, runs_) == component;
  });
  if (same_port) return {name, same_port, "connections to " + component + "." + connection.to.port};
  const std::string way = way_of(connection, *network);
  auto same_way = those([&](const ChainConnection& one) { return way_of(one, runs_) == way; });
  return {name, same_way, same_way ? "connections " + way : std::string()};
}

ChainStep MeasuredTimes::step(const std::string& task, const ChainNetwork* network) {
  const bool runs = network == nullptr || component_of(task, *network) == component_of(task, runs_);
  auto own = runs ? update_of(task) : std::nullopt;
  if (own || network == nullptr) return {task, own};
  const std::string component = component_of(task, *network);
  std::vector<StepTimes> all;
  for (const auto& [id, one] : runs_.tasks()) {
    const auto& update = one.component == component ? update_of(id) : std::nullopt;
    if (update) all.push_back(*update);
  }
  return {task, together(all), all.empty() ? std::string() : "tasks of " + component};
}

const std::optional<StepTimes>& MeasuredTimes::update_of(const std::string& task) {
  const auto [found, fresh] = updates_.try_emplace(task);
  if (!fresh) return found->second;
  const Value json = task_(task);
  const Value* timing = json.find("timing");
  if (timing == nullptr || number_at(*timing, "cycles") == 0) return found->second;
  StepTimes times{number_at(*timing, "mean_us") * 1e-6, number_at(*timing, "worst_us") * 1e-6,
                  number_at(*timing, "worst_us") * 1e-6};
  const Value* histograms = json.find("histograms");
  const Value* updates = histograms == nullptr ? nullptr : histograms->find("updates");
  if (updates != nullptr) times.p99 = number_at(*updates, "p99_us") * 1e-6;
  return found->second = times;
}

}  // namespace segue::cli
