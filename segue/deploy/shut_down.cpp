// SPDX-License-Identifier: Apache-2.0
#include <segue/deploy/shut_down.hpp>

#include <segue/base/log.hpp>
#include <segue/base/text.hpp>

#include <map>
#include <set>
#include <tuple>

namespace segue::deploy::detail {

namespace {

bool runs(TaskState state) {
  return state == TaskState::Running || state == TaskState::RunTimeError;
}

/// Carries out `verb` on all tasks in a state that is `wanted`, producers first, and logs failures.
void perform_on_all(const task_host::LocalTaskHost& host, task_host::ActionPool& pool, model::ActionKind verb,
                    bool (*wanted)(TaskState), TimePoint deadline) {
  const model::Network network = host.observe();
  const model::TaskIndex tasks(network);
  std::vector<model::Action> actions;
  for (const auto& id : producers_first(network)) {
    if (wanted(tasks.find(id)->state)) {
      actions.push_back({0, verb, model::TaskAction{id}, {}, {}});
    }
  }
  const auto outcomes = task_host::wait_for_outcomes(actions.size(), [&](task_host::Completion completed) {
    pool.begin(actions, deadline, std::move(completed));
  });
  for (const auto& outcome : outcomes) {
    if (!outcome) {
      log(LogLevel::Warning, "deploy", to_string(outcome.error()));
    }
  }
}

}  // namespace

std::vector<model::TaskId> producers_first(const model::Network& network) {
  std::map<model::TaskId, std::set<model::TaskId>> consumers;
  std::map<model::TaskId, std::size_t> producers;  // not in `ordered` yet
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
    // All others are part of a cycle or behind one: it is cut at the first of them.
    if (rest < network.tasks.size()) place(network.tasks[rest].id);
  }
  return ordered;
}

bool shut_down(const task_host::LocalTaskHost& host, task_host::ActionPool& pool, TimePoint deadline) {
  const TimePoint now = RealClock::instance().now();
  perform_on_all(host, pool, model::ActionKind::Stop, &runs, now + (deadline - now) / 2);
  // Includes tasks whose stop is still under way: the cleanup waits for it.
  perform_on_all(host, pool, model::ActionKind::Cleanup, &is_configured, deadline);
  bool at_rest = true;
  for (const auto& [task, why] : host.hanging()) {
    log(LogLevel::Warning, "deploy", "task " + quote(task.str()) + " is given up: " + why);
    at_rest = false;
  }
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
