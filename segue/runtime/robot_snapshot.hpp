// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/runtime/health.hpp>
#include <segue/runtime/pool_report.hpp>
#include <segue/task_host/task_host.hpp>

#include <string>
#include <vector>

/// The report of a runtime on its robot.
namespace segue::runtime {

/// A robot at one moment.
struct RobotSnapshot {
  task_host::TaskHost::View seen;
  std::vector<task_host::ComputerReport> computers;
  std::vector<std::string> differences;  ///< as Runtime::observed_differences()
  std::vector<PoolReport> pools;
  Health health;
};

}  // namespace segue::runtime
