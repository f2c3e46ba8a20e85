// SPDX-License-Identifier: Apache-2.0
#include <segue/deploy/shut_down.hpp>

#include <segue/base/log.hpp>
#include <segue/base/text.hpp>
#include <segue/deploy/staggered.hpp>

#include <map>
#include <set>
#include <tuple>

namespace segue::deploy::detail {

namespace {

/// Hooks that return sooner run one after the other.
constexpr Duration kPatience = std::chrono::milliseconds(20);

bool runs(TaskState state) {
  return state == TaskState::Running || state == TaskState::RunTimeError;
}

/// The verb for all tasks in such a state.
std::vector<std::function<void()>> steps_for(host::LocalTaskHost& host, model::ActionKind verb,
                                             bool (*wanted)(TaskState), TimePoint deadline) {
  const model::Network network = host.observe();
  std::set<model::TaskId> chosen;
  for (const auto& task : network.tasks) {
    if (wanted(task.state)) {
      chosen.insert(task.id);
    }
  }
  std::vector<std::function<void()>> steps;
  for (const auto& id : producers_first(network)) {
    if (!chosen.contains(id)) {
      continue;
    }
    steps.emplace_back([&host, verb, id, deadline] {
      const model::Action action{0, verb, model::TaskAction{id}, {}, {}};
      if (const auto done = host.perform(action, deadline); !done) {
        log(LogLevel::Warning, "deploy", to_string(done.error()));
      }
    });
  }
  return steps;
}

}  // namespace

std::vector<model::TaskId> producers_first(const model::Network& network) {
  std::map<model::TaskId, std::set<model::TaskId>> consumers;
  std::map<model::TaskId, std::size_t> producers;  // that do not stand yet
  for (const auto& connection : network.connections) {
    const auto& [from, to] = std::tie(connection.from.task, connection.to.task);
    if (from != to && consumers[from].insert(to).second) {
      ++producers[to];
    }
  }
  std::vector<model::TaskId> ordered;
  std::set<model::TaskId> placed;
  const auto place = [&](const model::TaskId& id) {
    if (placed.insert(id).second) {
      ordered.push_back(id);
    }
  };
  for (const auto& task : network.tasks) {
    if (producers[task.id] == 0) {
      place(task.id);
    }
  }
  std::size_t next = 0;
  for (std::size_t rest = 0; rest <= network.tasks.size(); ++rest) {
    for (; next < ordered.size(); ++next) {
      for (const auto& consumer : consumers[model::TaskId(ordered[next])]) {
        if (--producers[consumer] == 0) place(consumer);
      }
    }
    // All that remains is behind a cycle: it is cut at the first of them.
    if (rest < network.tasks.size()) place(network.tasks[rest].id);
  }
  return ordered;
}

bool shut_down(host::LocalTaskHost& host, TimePoint deadline) {
  const TimePoint now = RealClock::instance().now();
  Staggered stops(steps_for(host, model::ActionKind::Stop, &runs, deadline), kPatience);
  stops.run(now + (deadline - now) / 2);
  // Also where a stop is under way: the verb waits for it.
  Staggered cleanups(steps_for(host, model::ActionKind::Cleanup, &is_configured, deadline), kPatience);
  bool at_rest = cleanups.run(deadline);
  at_rest = stops.run(deadline) && at_rest;
  for (const auto& task : host.observe().tasks) {
    if (is_configured(task.state)) {
      log(LogLevel::Warning, "deploy",
          "task " + quote(task.id.str()) + " is given up, still " + quote(to_string(task.state)) +
              ": a hook of it has not returned");
      at_rest = false;
    }
  }
  return at_rest;
}

}  // namespace segue::deploy::detail
