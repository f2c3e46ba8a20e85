// SPDX-License-Identifier: Apache-2.0
#include "deployment_process.hpp"

#include <segue/base/log.hpp>
#include <segue/base/robot_name.hpp>
#include <segue/base/text.hpp>
#include <segue/control/server.hpp>
#include <segue/deploy/local_deployment.hpp>
#include <segue/model/files.hpp>
#include <segue/process_server/assignment.hpp>
#include <segue/process_server/inherited_process.hpp>
#include <segue/process_server/process_limits.hpp>
#include <segue/process_server/process_log.hpp>
#include <segue/sample_link/shared_memory.hpp>
#include <segue/task/realtime_log.hpp>
#include <segue/task_host/component_library.hpp>
#include <segue/task_host/local_task_host.hpp>
#include <segue/type/yaml.hpp>

#include <unistd.h>

#include <array>
#include <cstdlib>
#include <exception>
#include <functional>
#include <memory>
#include <utility>

namespace segue {

namespace {

using process_server::Assignment;
using process_server::Launch;

constexpr std::string_view kLogSource = "segue-deployment";
/// How often the process checks whether its log has to be rotated.
constexpr Duration kHousekeeping = std::chrono::seconds(1);
constexpr Duration kOutputLag =
    std::chrono::milliseconds(10);  ///< so it is woken at most a hundred times a second
/// How long tasks have to stop and be cleaned up when the process is asked to end.
constexpr Duration kShutDownTime = std::chrono::seconds(5);

int give_up(int status, const Error& error) {
  log(LogLevel::Error, kLogSource, to_string(error));
  return status;
}

LogLevel level_of(const std::string& name) {
  constexpr std::array kLevels = {LogLevel::Debug, LogLevel::Info, LogLevel::Warning, LogLevel::Error};
  for (const LogLevel level : kLevels) {
    if (to_string(level) == name) return level;
  }
  return LogLevel::Info;
}

/// Everything that tasks are created from.
struct Workshop {
  task_host::LibrarySet libraries;
  model::ComponentCatalog catalog;
  task_host::LocalOptions options;

  Result<void> load(const Launch& launch);
  Result<void> load_library(const std::string& name, bool may_lack);
  Result<void> load_models(const std::vector<std::string>& files);
};

/// A library may be missing where stand-ins simulate its components. Component models are read for stand-ins
/// only, since that takes longer than everything else.
Result<void> Workshop::load_library(const std::string& name, bool may_lack) {
  auto loaded = libraries.load(name);
  if (loaded) return {};
  if (!may_lack || loaded.error().code != ErrorCode::NotFound) return loaded;
  log(LogLevel::Warning, kLogSource, to_string(loaded.error()) + "; stand-ins take its place");
  return {};
}

Result<void> Workshop::load_models(const std::vector<std::string>& files) {
  Diagnostics diagnostics;
  for (const std::string& file : files)
    model::load_components(file, catalog, diagnostics);
  model::resolve_inheritance(catalog, diagnostics);
  if (diagnostics.has_errors()) return diagnostics.to_error();
  return {};
}

Result<void> Workshop::load(const Launch& launch) {
  for (const std::string& library : launch.deployment.libraries) {
    if (auto loaded = load_library(library, false); !loaded) return loaded;
  }
  options.never_stand_ins = libraries.components();
  options.stand_in = launch.stand_in;
  options.only_stand_ins = launch.only_stand_ins;
  const bool may_lack = launch.stand_in || launch.only_stand_ins;
  for (const std::string& library : launch.libraries) {
    if (auto loaded = load_library(library, may_lack); !loaded) return loaded;
    if (!launch.only_stand_ins) continue;
    auto models = libraries.export_models(library, catalog.types());
    if (!models) continue;
    for (auto& model : *models)
      catalog.add(std::move(model));
  }
  if (may_lack) {
    if (auto loaded = load_models(launch.models); !loaded) return loaded;
  }
  if (launch.stand_ins.empty()) return {};
  Diagnostics diagnostics;
  const auto document = type::parse_yaml(launch.stand_ins, "stand-ins");
  if (!document) return document.error();
  auto table = task_host::StandInTable::read(*document, "stand-ins", diagnostics);
  if (!table) return diagnostics.to_error();
  options.stand_ins = std::move(*table);
  return {};
}

/// Terminate handler: an exception in a library that is being loaded cannot pass through the dynamic loader.
[[noreturn]] void end_by_library() {
  std::string what = "an exception";
  try {
    if (const auto thrown = std::current_exception()) std::rethrow_exception(thrown);
  } catch (const std::exception& exception) {
    what = exception.what();
  } catch (...) {
    what = "an exception that is not a std::exception";
  }
  log(LogLevel::Error, kLogSource, "a component library failed while it was loaded: " + what);
  std::_Exit(process_server::kNoLibrary);
}

deploy::DeploymentInfo info_of(const Launch& launch, sample_link::Incarnation incarnation) {
  deploy::DeploymentInfo info;
  info.robot = launch.robot;
  info.deployment = launch.deployment;
  info.pid = ::getpid();
  info.software = SEGUE_VERSION;
  info.incarnation = incarnation;
  return info;
}

Result<std::shared_ptr<sample_link::SharedMemory>> memory_for(
    const Launch& launch, std::shared_ptr<sample_link::SharedMemory> prepared) {
  constexpr SharedMemoryOptions kUsual;
  const SharedMemoryOptions& wanted = launch.memory;
  const bool usual = wanted.prefault == kUsual.prefault && wanted.payload == kUsual.payload &&
                     wanted.control == kUsual.control;
  if (prepared != nullptr && usual) return prepared;
  return sample_link::SharedMemory::create(launch.memory);
}

/// Serves until the process is asked to end. If a hook hangs then, nothing may be destroyed, since its thread
/// still uses it: the process ends by std::_Exit.
int serve(const Assignment& assignment, const Workshop& workshop, PreparedProcess prepared,
          process_server::InheritedProcess& process) {
  const Launch& launch = assignment.launch;
  auto memory = memory_for(launch, std::move(prepared.memory));
  if (!memory) return give_up(process_server::kNoMemory, memory.error());
  const task::RealtimeLogDrain log_drain;
  task_host::LocalTaskHost tasks(workshop.libraries, workshop.catalog, workshop.options);
  deploy::LocalDeployment deployment(info_of(launch, (*memory)->incarnation()), tasks, *memory);
  auto server = control::Server::serve(process.take_listener(), &deployment);
  if (!server) return give_up(process_server::kNoMemory, server.error());
  process_server::OutputLog output(assignment.log, assignment.log_size, assignment.log_files,
                                   process.take_output_changes());
  while (!process.wait_for_end(kHousekeeping, output.changes()) && !process.wait_for_end(kOutputLag))
    output.rotate();
  if (!deployment.shut_down(RealClock::instance().now() + kShutDownTime)) {
    log(LogLevel::Error, kLogSource, "a hook of a task has not returned; ended without it");
    process.leave();
    std::_Exit(process_server::kHanging);
  }
  return process_server::kOrderly;
}

}  // namespace

PreparedProcess prepare_deployment_process() {
  static_cast<void>(task::RealtimeLog::instance());
  return {sample_link::SharedMemory::create().value_or(nullptr)};
}

int deployment_process(PreparedProcess prepared) {
  process_server::InheritedProcess process;
  const auto assignment = process_server::read_assignment(process_server::kAssignment);
  if (!assignment) return give_up(process_server::kWrongUse, assignment.error());
  set_log_level(level_of(assignment->launch.log_level));
  set_robot_of_process(assignment->launch.robot);
  process.begin(assignment->socket, SEGUE_VERSION);
  if (const auto applied = process_server::apply_to_this_process(assignment->launch); !applied) {
    return give_up(process_server::kNotPermitted, applied.error());
  }
  Workshop workshop;
  const auto terminate = std::set_terminate(&end_by_library);
  if (const auto loaded = workshop.load(assignment->launch); !loaded) {
    return give_up(process_server::kNoLibrary, loaded.error());
  }
  std::set_terminate(terminate);
  const int status = serve(*assignment, workshop, std::move(prepared), process);
  process.leave();
  return status;
}

}  // namespace segue
