// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/error.hpp>
#include <segue/journal/stored_units.hpp>
#include <segue/model/component_model.hpp>
#include <segue/runtime/belief.hpp>
#include <segue/runtime/change_count.hpp>
#include <segue/runtime/controller_registry.hpp>
#include <segue/runtime/event_log.hpp>
#include <segue/runtime/health_view.hpp>
#include <segue/runtime/journaling.hpp>
#include <segue/runtime/known_faults.hpp>
#include <segue/runtime/leases.hpp>
#include <segue/runtime/pool_keeper.hpp>
#include <segue/runtime/request_queue.hpp>
#include <segue/runtime/result_history.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/runtime_options.hpp>
#include <segue/runtime/standby_requests.hpp>
#include <segue/task_host/task_host.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

namespace segue::runtime::detail {

/// The parts of a Runtime that keep its state. Each has a lock of its own and is thread safe; that of the
/// queue may be held while those of the others are taken, and never the other way round.
struct RuntimeParts {
  RuntimeParts(std::string robot, task_host::TaskHost& task_host, const model::ComponentCatalog& components,
               RuntimeOptions runtime_options)
      : name(std::move(robot)),
        host(task_host),
        catalog(components),
        options(std::move(runtime_options)),
        journal(options.journal, options.robot_folder, log),
        units(unit_file(options), (options.robot_folder / name).string(), options.units),
        controllers(host, catalog, options.fallback, options.halt),
        history(options.kept_bytes),
        pools({host, belief, faults, log, journal}, options, [this] { queue.wake(); }),
        standby_requests({host, catalog, leases, controllers, log}, options.look_ahead) {}

  const std::string name;
  task_host::TaskHost& host;
  const model::ComponentCatalog& catalog;
  const RuntimeOptions options;
  ChangeCount changes;
  EventLog log;
  JournalKeeper journal;
  journal::StoredUnits units;
  Leases leases{log, journal, changes};
  Belief belief{host};
  ControllerRegistry controllers;
  ResultHistory history;
  KnownFaults faults{changes};
  RequestQueue queue{log};
  PoolKeeper pools;
  StandbyRequests standby_requests;
  TroubleTimes trouble_times;

  /// Why nothing is done any more: another runtime has got the robot.
  [[nodiscard]] std::optional<Error> refusal_of_lost_robot() const;
  /// The file of the counts of the robot's units, beside the journal; empty: none is kept.
  [[nodiscard]] static std::filesystem::path unit_file(const RuntimeOptions& options) {
    return options.journal.empty() ? std::filesystem::path() : options.journal.parent_path() / "units.sqlite";
  }
};

}  // namespace segue::runtime::detail
