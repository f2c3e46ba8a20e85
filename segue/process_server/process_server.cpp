// SPDX-License-Identifier: Apache-2.0
#include <segue/base/error.hpp>
#include <segue/base/folders.hpp>
#include <segue/base/log.hpp>
#include <segue/base/text.hpp>
#include <segue/process_server/os_process.hpp>
#include <segue/process_server/process_cgroup.hpp>
#include <segue/process_server/process_log.hpp>
#include <segue/process_server/process_server.hpp>
#include <segue/process_server/process_server_implementation.hpp>
#include <segue/process_server/spawn.hpp>

#include <algorithm>
#include <cerrno>
#include <csignal>

namespace segue::process_server {

namespace {

namespace fs = std::filesystem;
using detail::ProcessEntry;
using detail::ProcessPlace;

constexpr std::string_view kLogSource = "process server";
/// How long a process may take to end after SIGKILL.
constexpr Duration kKillTime = std::chrono::seconds(10);

std::string named(const ProcessInfo& process) {
  return "process " + quote(process.robot + '/' + process.key.process.str());
}

Error already_runs(const ProcessInfo& process) {
  return fail(ErrorCode::AlreadyExists,
              named(process) + (process.pid == 0 ? std::string(" is just starting")
                                                 : " runs already (pid " + std::to_string(process.pid) + ")"),
              process.key.process.str());
}

Error not_running(const std::string& robot, const model::DeploymentKey& key) {
  return fail(ErrorCode::NotFound, "no process " + quote(robot + '/' + key.process.str()) + " runs",
              key.process.str());
}

Result<ProcessInfo> info_of(const std::string& robot, const model::DeploymentKey& key) {
  auto socket = process_socket(robot, key);
  if (!socket) return std::move(socket.error());
  ProcessInfo info;
  info.robot = robot;
  info.key = key;
  info.log = process_log(*socket);
  info.socket = std::move(*socket);
  return info;
}

}  // namespace

ProcessServer::Implementation::Implementation(ProcessServerOptions chosen, fs::path found)
    : options(std::move(chosen)), program(std::move(found)) {}

Result<void> ProcessServer::Implementation::begin() {
  auto created = detail::ProcessWatch::create([this](std::uint64_t id) { finish(id); });
  if (!created) return std::move(created.error());
  watch = std::move(*created);
  if (options.zygote || !options.zygote_libraries.empty()) begin_zygote();
  return {};
}

/// Without a zygote processes start all the same, only slower.
void ProcessServer::Implementation::begin_zygote() {
  const auto folder = runtime_folder();
  auto started = folder ? detail::Zygote::start(program, options.zygote_libraries, *folder / "zygote.log")
                        : folder.error();
  if (started) {
    zygote = std::move(*started);
  } else {
    log(LogLevel::Error, kLogSource, "cannot start a zygote: " + to_string(started.error()));
  }
}

bool ProcessServer::Implementation::fork(const Launch& what, ProcessEntry& entry,
                                         const detail::HandedOver& files) {
  // The dynamic loader reads its variables when a program is executed, which a zygote's child is not.
  const bool loader = std::ranges::any_of(what.deployment.environment,
                                          [](const auto& each) { return each.first.starts_with("LD_"); });
  if (!zygote || zygote_failed || loader) return false;
  const auto pid = zygote->launch(detail::process_title(what.robot, entry.info.socket), files);
  if (pid) {
    set_pid(entry, *pid);
    entry.zygote = true;
    return true;
  }
  if (pid.error().code == ErrorCode::Unavailable && !zygote_failed.exchange(true)) {
    log(LogLevel::Error, kLogSource,
        "the zygote is gone, so processes start without it from now on: " + to_string(pid.error()));
  }
  return false;
}

ProcessServer::Implementation::Entry ProcessServer::Implementation::adopt(const ProcessInfo& info) {
  if (auto known = table.find(info.robot, info.key)) return known;
  auto found = detail::find_process(info.socket, detail::process_title(info.robot, info.socket));
  if (!found || !found->has_value()) return nullptr;
  auto entry = table.add(info);
  entry->info.pid = (*found)->pid;
  entry->info.adopted = true;
  entry->software = (*found)->software;
  entry->pidfd = std::move((*found)->pidfd);
  if (auto watched = watch->add(entry->pidfd.get(), entry->id); !watched) {
    log(LogLevel::Error, kLogSource, named(info) + " cannot be adopted: " + to_string(watched.error()));
    table.remove(*entry);
    return nullptr;
  }
  return entry;
}

void ProcessServer::Implementation::adopt_all(const std::string& robot, const fs::path& folder) {
  std::error_code failed;
  for (fs::directory_iterator file(folder, failed), end; !failed && file != end; file.increment(failed)) {
    const auto key = key_of_socket(file->path());
    if (!key) continue;
    if (auto info = info_of(robot, *key)) adopt(*info);
  }
}

/// A process of another version of Segue is ended first, since its protocol may differ.
Result<ProcessServer::Implementation::Entry> ProcessServer::Implementation::reserve(const ProcessInfo& info,
                                                                                    TimePoint deadline) {
  for (;;) {
    Lock lock(mutex);
    const auto known = adopt(info);
    if (!known) {
      auto entry = table.add(info);
      entry->starting = true;
      return entry;
    }
    const bool other_version = known->info.adopted && known->software != kSoftware;
    if (!other_version) return already_runs(known->info);
    lock.unlock();
    log(LogLevel::Warning, kLogSource,
        named(info) + " is of version " + quote(known->software) + " and is replaced");
    const auto stopped = stop(known->info, deadline, true);
    if (!stopped && stopped.error().code != ErrorCode::NotFound) return stopped.error();
  }
}

Result<void> ProcessServer::Implementation::launch(const Launch& what, ProcessEntry& entry,
                                                   ProcessPlace& place) {
  const auto assignment =
      write_assignment({what, entry.info.socket, entry.info.log, options.log_size, options.log_files});
  if (!assignment) return assignment.error();
  const auto output = open_log(entry.info.log);
  // A full disk must not keep a robot from starting.
  if (!output)
    log(LogLevel::Error, kLogSource,
        "output of " + named(entry.info) + " is lost: " + to_string(output.error()));
  auto changes = open_output_changes();
  if (!changes) return std::move(changes.error());
  entry.output_changes = std::move(*changes);
  const detail::HandedOver files{output ? output->get() : -1, assignment->get(), place.socket(), place.lock(),
                                 entry.output_changes.get()};
  if (fork(what, entry, files)) return {};
  const std::string title = detail::process_title(what.robot, entry.info.socket);
  auto pid = detail::spawn(program, {title}, what.deployment.environment, files);
  if (!pid) return std::move(pid.error());
  set_pid(entry, *pid);
  return {};
}

/// Under the lock, since start() of the same name reads it for its error message.
void ProcessServer::Implementation::set_pid(ProcessEntry& entry, int pid) {
  const Lock lock(mutex);
  entry.info.pid = pid;
}

/// Closing it may take 20 ms, for which the ends of other processes need not wait.
void ProcessServer::Implementation::retire(Descriptor output_changes) {
  closing.submit([last = std::make_shared<Descriptor>(std::move(output_changes))] {});
}

fs::path ProcessServer::Implementation::enter_group(const ProcessEntry& entry,
                                                    std::optional<std::uint64_t> memory) const {
  if (options.cgroup.empty()) return {};
  auto group = detail::enter_cgroup(
      options.cgroup, detail::process_title(entry.info.robot, entry.info.socket), entry.info.pid, memory);
  if (group.empty()) {
    log(LogLevel::Warning, kLogSource,
        named(entry.info) + " runs without a control group: " + quote(options.cgroup.native()) +
            " cannot be used");
  }
  return group;
}

Result<ProcessInfo> ProcessServer::Implementation::settle(const Entry& entry, ProcessPlace& place,
                                                          std::optional<std::uint64_t> memory) {
  Descriptor pidfd(detail::open_pidfd(entry->info.pid));
  const int reason = errno;
  entry->cgroup = enter_group(*entry, memory);
  const Lock lock(mutex);
  auto watched = pidfd.valid() ? watch->add(pidfd.get(), entry->id)
                               : Result<void>(system_error("cannot watch " + named(entry->info), reason));
  if (!watched) {
    detail::kill_group(entry->info.pid);
    detail::reap_child(entry->info.pid);
    return std::move(watched.error());
  }
  entry->pidfd = std::move(pidfd);
  entry->software = kSoftware;
  entry->starting = false;
  place.keep();
  changed.notify_all();
  return entry->info;
}

Result<ProcessInfo> ProcessServer::Implementation::start(const Launch& what, TimePoint deadline) {
  const auto key = what.deployment.key();
  auto info = info_of(what.robot, key);
  if (!info) return info;
  auto entry = reserve(*info, deadline);
  if (!entry) return std::move(entry.error());
  auto started = [&]() -> Result<ProcessInfo> {
    auto place = ProcessPlace::claim(info->socket, deadline);
    if (!place) return std::move(place.error());
    if (auto launched = launch(what, **entry, *place); !launched) return std::move(launched.error());
    return settle(*entry, *place, what.deployment.limits.memory);
  }();
  if (!started) {
    const Lock lock(mutex);
    table.remove(**entry);
    changed.notify_all();
  }
  return started;
}

/// Adds the end of a process to its log, so that the log of one that crashed says so. On a full disk the line
/// is missing.
void note_in_log(const ProcessInfo& ended, const ExitReason& reason) {
  const auto log_file = ended.log.empty() ? Result<Descriptor>(Descriptor()) : open_log(ended.log);
  if (!log_file || !log_file->valid()) return;
  const std::string line =
      "segue: the process (pid " + std::to_string(ended.pid) + ") " + to_string(reason) + '\n';
  const ssize_t written = ::write(log_file->get(), line.data(), line.size());
  static_cast<void>(written);
}

/// The process group is killed before its leader is reaped: until then the pid cannot belong to another
/// process. All that may take long is done without the mutex; an entry that is `ending` belongs to this
/// thread, and its name stays taken.
void ProcessServer::Implementation::finish(std::uint64_t id) {
  ExitReason asked;
  Entry entry;
  {
    const Lock lock(mutex);
    entry = table.find(id);
    if (!entry) return;
    entry->ending = true;
    asked.requested = entry->stop_requested;
    asked.killed = entry->killed;
    watch->remove(entry->pidfd.get());
  }
  const ProcessInfo& info = entry->info;
  if (!info.adopted) detail::kill_group(info.pid);
  detail::kill_cgroup(entry->cgroup);
  ExitReason reason = entry->zygote ? zygote->reap(info.pid) : detail::reap(entry->pidfd.get());
  reason.requested = asked.requested;
  reason.killed = asked.killed && (!reason.known || reason.signal == SIGKILL);
  detail::remove_cgroup(entry->cgroup);
  detail::remove_if_stale(info.socket);
  if (!reason.requested) note_in_log(info, reason);
  retire(std::move(entry->output_changes));
  ProcessInfo ended = info;
  ended.exit = reason;
  {
    const Lock lock(mutex);
    entry->info.exit = reason;
    table.remove(*entry);
    changed.notify_all();
  }
  const Lock lock(listener_mutex);
  if (listener) listener(ended);
}

Result<ExitReason> ProcessServer::Implementation::stop(const ProcessInfo& info, TimePoint deadline,
                                                       bool orderly) {
  Lock lock(mutex);
  const auto entry = adopt(info);
  if (!entry) return not_running(info.robot, info.key);
  changed.wait_until(mutex, deadline, [&]() SEGUE_REQUIRES(mutex) { return !entry->starting; });
  const bool there = table.find(entry->id) == entry;
  if (entry->starting && !there) return not_running(info.robot, info.key);
  if (entry->starting) {
    return fail(ErrorCode::DeadlineExceeded, named(info) + " is still being started");
  }
  const auto ended = [&] { return entry->info.exit.has_value(); };
  if (!ended()) {
    entry->stop_requested = true;
    if (orderly) detail::signal_pidfd(entry->pidfd.get(), SIGTERM);
  }
  if (orderly ? changed.wait_until(mutex, deadline, ended) : ended()) return *entry->info.exit;
  entry->killed = true;
  if (!entry->ending) detail::kill_group(entry->info.pid);
  if (changed.wait_until(mutex, RealClock::instance().now() + kKillTime, ended)) return *entry->info.exit;
  return fail(ErrorCode::DeadlineExceeded,
              named(info) + " (pid " + std::to_string(entry->info.pid) +
                  ") did not end although it was killed; it probably waits in a device driver");
}

Result<std::unique_ptr<ProcessServer>> ProcessServer::create(const ProcessServerOptions& options) {
  auto program = detail::find_program(options.program);
  if (!program) return std::move(program.error());
  auto implementation = std::make_unique<Implementation>(options, std::move(*program));
  if (auto begun = implementation->begin(); !begun) return std::move(begun.error());
  return std::unique_ptr<ProcessServer>(new ProcessServer(std::move(implementation)));
}

ProcessServer::ProcessServer(std::unique_ptr<Implementation> implementation)
    : implementation_(std::move(implementation)) {}

ProcessServer::~ProcessServer() = default;

Result<ProcessInfo> ProcessServer::start(const Launch& launch, TimePoint deadline) {
  return implementation_->start(launch, deadline);
}

Result<ExitReason> ProcessServer::stop(const std::string& robot, const model::DeploymentKey& key,
                                       TimePoint deadline) {
  auto info = info_of(robot, key);
  if (!info) return std::move(info.error());
  return implementation_->stop(*info, deadline, true);
}

Result<ExitReason> ProcessServer::kill(const std::string& robot, const model::DeploymentKey& key,
                                       TimePoint deadline) {
  auto info = info_of(robot, key);
  if (!info) return std::move(info.error());
  return implementation_->stop(*info, deadline, false);
}

Result<std::vector<ProcessInfo>> ProcessServer::processes(const std::string& robot) {
  const auto folder = process_folder(robot);
  if (!folder) return folder.error();
  const Lock lock(implementation_->mutex);
  implementation_->adopt_all(robot, *folder);
  std::vector<ProcessInfo> processes;
  for (const auto& entry : implementation_->table.of(robot)) {
    if (!entry->starting) processes.push_back(entry->info);
  }
  return processes;
}

void ProcessServer::set_listener(Listener listener) {
  const Lock lock(implementation_->listener_mutex);
  implementation_->listener = std::move(listener);
}

}  // namespace segue::process_server
