// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/ids.hpp>
#include <segue/runtime/health.hpp>
#include <segue/runtime/pool_report.hpp>
#include <segue/runtime/readiness.hpp>
#include <segue/solve/combine.hpp>
#include <segue/task_host/task_host.hpp>

#include <string>
#include <vector>

/// The report of a runtime on its robot.
namespace segue::runtime {

/// Why two controllers cannot run at once; with `influence`: they can, but `a` changes what tasks of `b` get
/// (solve::influences).
struct ControllerConflict {
  model::NetworkName a;
  model::NetworkName b;
  solve::Conflict conflict;
  bool influence = false;
};

/// A robot at one moment.
struct RobotSnapshot {
  task_host::TaskHost::View seen;
  std::vector<task_host::ComputerReport> computers;
  std::vector<std::string> differences;  ///< as Runtime::observed_differences()
  std::vector<PoolReport> pools;
  Health health;
};

}  // namespace segue::runtime
