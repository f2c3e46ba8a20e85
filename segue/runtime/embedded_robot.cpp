// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/embedded_robot.hpp>

#include <segue/base/file.hpp>
#include <segue/base/log.hpp>
#include <segue/base/text.hpp>
#include <segue/distributed/gateways.hpp>
#include <segue/journal/journal.hpp>
#include <segue/model/files.hpp>
#include <segue/model/validate.hpp>
#include <segue/runtime/controller_files.hpp>
#include <segue/runtime/host_places.hpp>
#include <segue/runtime/planning.hpp>
#include <segue/runtime/robot_tasks.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/runtime_options.hpp>
#include <segue/task/realtime_log.hpp>
#include <segue/task_host/component_library.hpp>
#include <segue/task_host/stand_in.hpp>

#include <cstdio>
#include <cstdlib>
#include <functional>

namespace segue::runtime {

namespace fs = std::filesystem;

struct EmbeddedRobot::Implementation {
  bool load(const fs::path& file, const EmbeddedOptions& options, Diagnostics& diagnostics);
  void load_libraries(Diagnostics& diagnostics, bool required);
  void add_components_of(const std::string& library, const std::function<void(const Error&)>& report);
  void load_models(Diagnostics& diagnostics);
  void start(const ControllerSet& controllers, task_host::LocalOptions local, const EmbeddedOptions& options,
             Diagnostics& diagnostics);
  [[nodiscard]] fs::path journal_path(const EmbeddedOptions& options, Diagnostics& diagnostics) const;
  [[nodiscard]] fs::path robot_folder() const;

  Diagnostics findings;
  model::Robot robot;
  model::ComponentCatalog catalog;
  task_host::LibrarySet libraries;
  task::RealtimeLogDrain log_drain;  ///< destroyed after the tasks, so that it prints their last lines
  std::optional<ControllerFiles> files;
  std::unique_ptr<detail::RobotTasks> tasks;
  std::unique_ptr<Runtime> runtime;
};

bool EmbeddedRobot::Implementation::load(const fs::path& file, const EmbeddedOptions& options,
                                         Diagnostics& diagnostics) {
  auto read = read_robot_files(file, diagnostics);
  if (!read) {
    return false;
  }
  files.emplace(file, *read);
  if (auto changed = model::apply(options.changes, read->robot, read->controllers.controllers); !changed) {
    diagnostics.error("change", changed.error().message, read->robot.where);
    return false;
  }
  robot = read->robot;
  task_host::LocalOptions local{options.stand_in, options.only_stand_ins, {}};
  if (!options.stand_ins.empty()) {
    if (auto table = task_host::StandInTable::load(options.stand_ins, diagnostics)) {
      local.stand_ins = std::move(*table);
    }
  }
  load_libraries(diagnostics, !options.stand_in && !options.only_stand_ins);
  load_models(diagnostics);
  if (has_other_hosts(robot)) {
    for (auto& gateway : distributed::gateway_models()) {
      catalog.add(std::move(gateway));
    }
  }
  diagnostics.append(model::validate(robot, read->controllers.controllers));
  model::check_halt_members(robot, read->controllers.controllers, catalog, diagnostics);
  if (diagnostics.has_errors()) {
    return false;
  }
  start(read->controllers, std::move(local), options, diagnostics);
  return !diagnostics.has_errors();
}

/// Exports the interfaces from the loaded components, so that the checked models are those that run.
void EmbeddedRobot::Implementation::load_libraries(Diagnostics& diagnostics, bool required) {
  const auto report = [&](const Error& error) {
    if (required) {
      diagnostics.error("library", to_string(error), robot.where);
    } else {
      diagnostics.warning("library", to_string(error) + "; stand-ins take its place", robot.where);
    }
  };
  for (const auto& library : robot.libraries) {
    if (auto loaded = libraries.load(library); !loaded) {
      report(loaded.error());
      continue;
    }
    add_components_of(library, report);
  }
  // Components of this program need no library.
  add_components_of("", report);
}

void EmbeddedRobot::Implementation::add_components_of(const std::string& library,
                                                      const std::function<void(const Error&)>& report) {
  auto models = libraries.export_models(library, catalog.types());
  if (!models) {
    report(models.error());
    return;
  }
  for (auto& model : *models) {
    catalog.add(std::move(model));
  }
}

void EmbeddedRobot::Implementation::load_models(Diagnostics& diagnostics) {
  for (const auto& pattern : robot.models) {
    for (const auto& file : glob_files(robot.folder / pattern)) {
      model::load_components(file, catalog, diagnostics);
    }
  }
  model::resolve_inheritance(catalog, diagnostics);
}

/// Empty if no journal is kept. A missing journal does not keep the robot from running.
fs::path EmbeddedRobot::Implementation::journal_path(const EmbeddedOptions& options,
                                                     Diagnostics& diagnostics) const {
  if (!options.journal || !options.journal_file.empty()) {
    return options.journal ? options.journal_file : fs::path();
  }
  auto path = journal::default_path(robot.name);
  if (!path) {
    diagnostics.warning("journal", to_string(path.error()), robot.where);
  }
  return path.value_or(fs::path());
}

fs::path EmbeddedRobot::Implementation::robot_folder() const {
  std::error_code failed;
  const fs::path folder = fs::weakly_canonical(fs::absolute(robot.folder, failed), failed);
  return failed ? robot.folder : folder;
}

void EmbeddedRobot::Implementation::start(const ControllerSet& controllers, task_host::LocalOptions local,
                                          const EmbeddedOptions& options, Diagnostics& diagnostics) {
  auto created = detail::RobotTasks::create(robot, libraries, catalog, std::move(local), options);
  if (!created) {
    diagnostics.error("processes", to_string(created.error()), robot.where);
    return;
  }
  tasks = std::move(*created);
  for (const auto& network : controllers.controllers) {
    tasks->host().expect(network);
  }
  const model::Network pools = model::pool_network(robot.pools);
  tasks->host().expect(pools);
  diagnostics.append(detail::check_runnable(pools, tasks->host(), catalog));
  if (diagnostics.has_errors()) {
    return;
  }
  runtime =
      std::make_unique<Runtime>(robot.name, tasks->host(), catalog,
                                RuntimeOptions{robot.fallback, robot.halt, robot.policies, robot.look_ahead,
                                               journal_path(options, diagnostics), robot_folder(),
                                               robot.pools, robot.pool_budget, robot.units});
  diagnostics.append(runtime->load(controllers));
  if (!runtime->belief().empty()) {
    runtime->reset_belief();  // adopted deployments: find the name of the controller that they run
  }
}

EmbeddedRobot::EmbeddedRobot(std::unique_ptr<Implementation> implementation)
    : implementation_(std::move(implementation)) {}

EmbeddedRobot::EmbeddedRobot(EmbeddedRobot&& other) noexcept = default;

EmbeddedRobot& EmbeddedRobot::operator=(EmbeddedRobot&& other) noexcept = default;

EmbeddedRobot::~EmbeddedRobot() = default;

Result<EmbeddedRobot> EmbeddedRobot::open(const fs::path& file, const EmbeddedOptions& options) {
  auto created = std::make_unique<Implementation>();
  Diagnostics& findings = created->findings;
  if (!created->load(file, options, findings)) {
    findings.sort();
    return findings.to_error();
  }
  return EmbeddedRobot(std::move(created));
}

const Diagnostics& EmbeddedRobot::warnings() const {
  return implementation_->findings;
}

const model::Robot& EmbeddedRobot::robot() const {
  return implementation_->robot;
}

const model::ComponentCatalog& EmbeddedRobot::catalog() const {
  return implementation_->catalog;
}

task_host::TaskHost& EmbeddedRobot::host() {
  return implementation_->tasks->host();
}

Runtime& EmbeddedRobot::runtime() {
  return *implementation_->runtime;
}

Result<void> EmbeddedRobot::write(std::string_view port, const type::Value& sample, Duration timeout) {
  auto to = member_of(port);
  if (!to) {
    return std::move(to.error());
  }
  return host().write(*to, sample, Deadline(timeout));
}

Result<void> EmbeddedRobot::set(std::string_view property, const type::Value& value, Duration timeout) {
  auto of = member_of(property);
  if (!of) {
    return std::move(of.error());
  }
  return runtime().set_property(of->task, of->port, value, {}, Deadline(timeout));
}

Result<type::Value> EmbeddedRobot::call(std::string_view operation, const type::Value& arguments,
                                        Duration timeout) {
  auto of = member_of(operation);
  if (!of) {
    return std::move(of.error());
  }
  return runtime().call(of->task, of->port, arguments, timeout);
}

SwitchResult EmbeddedRobot::switch_to(std::string_view controller, RequestOptions options) {
  return implementation_->runtime->switch_to(model::NetworkName(controller), std::move(options));
}

const ControllerFiles& EmbeddedRobot::files() const {
  return *implementation_->files;
}

ApplyResult EmbeddedRobot::apply(RequestOptions options) {
  Diagnostics diagnostics;
  auto set = files().read(diagnostics);
  if (!set) {
    return {Outcome::Refused, {}, {}, diagnostics.to_error()};
  }
  return runtime().apply(std::move(*set), std::move(options)).get();
}

SwitchResult EmbeddedRobot::shut_down() {
  implementation_->runtime->prepare({});  // end standby
  if (implementation_->robot.halt && !implementation_->runtime->belief().empty()) {
    implementation_->runtime->halt({"shut-down"}).wait();
  }
  SwitchResult result = implementation_->runtime->take_down().get();
  if (!result.ok()) {
    // The new snapshot shows what failed, such as a task that hangs, so another transition may succeed.
    result = implementation_->runtime->take_down().get();
  }
  if (!result.ok()) {
    implementation_->tasks->end_processes();
  }
  return result;
}

void EmbeddedRobot::exit_if_hanging(int status) {
  if (implementation_->tasks->at_rest()) {
    return;
  }
  log(LogLevel::Error, implementation_->robot.name,
      "a task in the runtime's own process has not returned; the process ends without it");
  implementation_->runtime.reset();  // its journal is complete then
  std::fflush(nullptr);
  std::_Exit(status);
}

}  // namespace segue::runtime
