// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/transition.hpp>
#include <segue/task_host/local_task_host.hpp>

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <string_view>

/// Short ways to say actions and networks in tests.
namespace segue::task_host::testing {

inline TimePoint soon() {
  return RealClock::instance().now() + std::chrono::seconds(30);
}

inline model::Action on_task(model::ActionKind kind, std::string_view task) {
  return {1, kind, model::TaskAction{model::TaskId(task)}, model::Phase::Commit, {}};
}

inline model::Action on_connection(model::ActionKind kind, const model::Connection& connection) {
  return {1, kind, model::ConnectionAction{connection}, model::Phase::Commit, {}};
}

inline model::Action on_process(model::ActionKind kind, std::string_view process) {
  model::Deployment deployment;
  deployment.process = model::ProcessName(process);
  return {1, kind, model::DeploymentAction{deployment}, model::Phase::Commit, {}};
}

inline model::Action apply(const model::Task& definition, std::string_view process = "") {
  model::ConfigAction what;
  what.definition = definition;
  if (!process.empty()) {
    what.process = {model::kLocalHost, model::ProcessName(process)};
  }
  what.name = definition.id.str();
  return {1, model::ActionKind::ApplyConfig, what, model::Phase::Commit, {}};
}

inline model::Task task_of(std::string_view id, std::string_view component,
                           type::Value properties = type::ValueMap{}) {
  model::Task task;
  task.id = model::TaskId(id);
  task.component = model::ComponentName(component);
  task.properties = std::move(properties);
  return task;
}

inline model::Connection wire(std::string_view from, std::string_view from_port, std::string_view to,
                              std::string_view to_port) {
  model::Connection connection;
  connection.from = {model::TaskId(from), std::string(from_port)};
  connection.to = {model::TaskId(to), std::string(to_port)};
  return connection;
}

}  // namespace segue::task_host::testing
