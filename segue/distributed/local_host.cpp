// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>
#include <segue/distributed/local_host.hpp>

#include <segue/base/file.hpp>
#include <segue/base/folders.hpp>
#include <segue/base/log.hpp>
#include <segue/base/sha256.hpp>
#include <segue/base/text.hpp>
#include <segue/distributed/library_inventory.hpp>
#include <segue/distributed/local_robot.hpp>
#include <segue/process_server/process_hub.hpp>

#include <sys/utsname.h>
#include <unistd.h>

#include <map>
#include <set>
#include <utility>

namespace segue::distributed {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMaxRobots = 64;
constexpr std::size_t kMostLog = std::size_t{1} << 20;
constexpr std::string_view kEpochSuffix = ".epoch";

/// "arm.yaml" as "000_arm.yaml": whatever a runtime names its file, it is not a path here.
std::string file_name(std::size_t number, const std::string& name) {
  std::string safe;
  for (const char c : name) {
    safe += is_identifier(std::string("x") + c) ? c : '_';
  }
  std::string digits = std::to_string(number);
  return std::string(3 - std::min<std::size_t>(3, digits.size()), '0') + digits + "_" + safe.substr(0, 100);
}

Error not_a_robot(const std::string& name) {
  return fail(ErrorCode::InvalidArgument, quote(name.substr(0, 64)) + " is not a valid robot name");
}

std::string architecture() {
  utsname system{};
  return ::uname(&system) == 0 ? system.machine : "unknown";
}

}  // namespace

struct LocalHost::Implementation {
  Implementation(process_server::ProcessService& service, fleet::Connector how,
                 const LocalHostOptions& chosen)
      : hub(service), processes(hub.for_all()), connector(std::move(how)), options(chosen) {}

  Result<std::shared_ptr<detail::LeasedRobot>> leased(const std::string& robot);
  /// Forgets robots that nobody commands and of which no process runs.
  void forget_unused() SEGUE_REQUIRES(mutex);
  Result<process_server::Launch> launch_of(const RobotRequest& request) const;
  /// All robots that have ever had a lease here, as if nobody had it now.
  [[nodiscard]] std::map<std::string, LeaseInfo> kept() const;
  [[nodiscard]] fs::path robots_folder() const { return options.state / "robots"; }
  [[nodiscard]] fs::path epoch_file(const std::string& robot) const {
    return robots_folder() / (robot + std::string(kEpochSuffix));
  }

  process_server::ProcessHub hub;
  const std::unique_ptr<process_server::ProcessService> processes;
  const fleet::Connector connector;
  const LocalHostOptions options;
  LibraryInventory libraries;
  Mutex mutex;  ///< protects the member below
  std::map<std::string, std::shared_ptr<detail::LeasedRobot>> robots SEGUE_GUARDED_BY(mutex);
};

Result<std::shared_ptr<detail::LeasedRobot>> LocalHost::Implementation::leased(const std::string& robot) {
  if (!is_identifier(robot)) {
    return not_a_robot(robot);
  }
  const Lock lock(mutex);
  if (robots.size() >= kMaxRobots && !robots.contains(robot)) {
    forget_unused();
  }
  auto& found = robots[robot];
  if (found == nullptr) {
    if (robots.size() > kMaxRobots) {
      robots.erase(robot);
      return fail(ErrorCode::ResourceExhausted, "this host has leases of " + std::to_string(kMaxRobots) +
                                                    " robots already, which is the limit");
    }
    found = std::make_shared<detail::LeasedRobot>(robot, epoch_file(robot), options.clock);
  }
  return found;
}

/// Their epochs are in files, so that the next runtime of such a robot gets a higher one.
void LocalHost::Implementation::forget_unused() {
  std::erase_if(robots, [this](const auto& entry) {
    const auto& [name, robot] = entry;
    if (robot.use_count() > 1 || robot->lease.info().left > Duration(0)) {
      return false;  // somebody has it, or had it and may still send something under its epoch
    }
    const auto running = processes->processes(name);
    return running && running->empty();
  });
}

std::map<std::string, LeaseInfo> LocalHost::Implementation::kept() const {
  std::map<std::string, LeaseInfo> leases;
  std::error_code error;
  for (fs::directory_iterator entry(robots_folder(), error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string robot = entry->path().stem().string();
    if (entry->path().extension() == kEpochSuffix && is_identifier(robot)) {
      leases.emplace(robot, Lease(robot, entry->path(), RealClock::instance()).info());
    }
  }
  return leases;
}

/// Model files of another computer become files here.
Result<process_server::Launch> LocalHost::Implementation::launch_of(const RobotRequest& request) const {
  process_server::Launch launch = request.launch;
  launch.models.clear();
  if (request.models.empty()) {
    return launch;
  }
  const fs::path folder = robots_folder() / (launch.robot + ".models");
  if (auto made = make_private_folder(folder); !made) {
    return made.error();
  }
  std::set<fs::path> written;
  for (const auto& [name, text] : request.models) {
    const fs::path file = folder / file_name(launch.models.size(), name);
    if (auto kept = read_file(file); !kept || *kept != text) {
      if (auto stored = write_file(file, text); !stored) {
        return stored.error();
      }
    }
    launch.models.push_back(file.string());
  }
  return launch;
}

LocalHost::LocalHost(std::unique_ptr<Implementation> implementation)
    : implementation_(std::move(implementation)) {}

/// Robots that were given out may outlive this, but the processes' service need not.
LocalHost::~LocalHost() {
  const Lock lock(implementation_->mutex);
  for (const auto& [name, robot] : implementation_->robots) {
    const TimedWriteLock one(robot->acquiring, TimePoint::max());
    robot->lease.close();
    robot->here.reset();
  }
}

Result<std::unique_ptr<LocalHost>> LocalHost::create(process_server::ProcessService& processes,
                                                     fleet::Connector connector,
                                                     const LocalHostOptions& options) {
  for (const auto& folder : {options.state, options.state / "robots"}) {
    if (auto made = make_private_folder(folder); !made) {
      return made.error();
    }
  }
  return std::unique_ptr<LocalHost>(
      new LocalHost(std::make_unique<Implementation>(processes, std::move(connector), options)));
}

Result<HostInfo> LocalHost::info() {
  return HostInfo{implementation_->options.name, SEGUE_VERSION, architecture(), ::getpid(),
                  implementation_->libraries.list()};
}

Result<std::chrono::system_clock::time_point> LocalHost::clock() {
  return std::chrono::system_clock::now();
}

Result<std::vector<LeaseInfo>> LocalHost::robots() {
  std::map<std::string, LeaseInfo> known = implementation_->kept();
  {
    const Lock lock(implementation_->mutex);
    for (const auto& [name, robot] : implementation_->robots) {
      known[name] = robot->lease.info();
    }
  }
  std::vector<LeaseInfo> all;
  for (auto& [name, lease] : known) {
    const auto running = implementation_->processes->processes(name);
    if (!lease.holder.empty() || (running && !running->empty())) {
      all.push_back(std::move(lease));
    }
  }
  return all;
}

Result<std::uint64_t> LocalHost::highest_term(const std::string& robot) {
  if (!is_identifier(robot)) {
    return not_a_robot(robot);
  }
  const Lock lock(implementation_->mutex);
  const auto known = implementation_->robots.find(robot);
  return known != implementation_->robots.end()
             ? known->second->lease.highest_term()
             : Lease(robot, implementation_->epoch_file(robot), RealClock::instance()).highest_term();
}

Result<process_server::LogPart> LocalHost::log(const LogRequest& request) {
  const auto folder = runtime_folder();
  if (!folder) {
    return folder.error();
  }
  if (!is_identifier(request.robot) || !fs::exists(*folder / request.robot)) {
    return fail(ErrorCode::NotFound,
                "no robot " + quote(request.robot.substr(0, 64)) + " has processes here");
  }
  const auto socket =
      process_server::process_socket(request.robot, {implementation_->options.name, request.process});
  if (!socket) {
    return socket.error();
  }
  const fs::path log = process_server::process_log(*socket);
  auto part = request.after ? process_server::log_after(log, *request.after)
                            : process_server::log_tail(log, request.lines, kMostLog);
  if (!part && part.error().code == ErrorCode::NotFound) {
    return fail(ErrorCode::NotFound, "robot " + quote(request.robot) + " has no output of process " +
                                         quote(request.process.str()) + " here");
  }
  return part;
}

Result<std::shared_ptr<HostedRobot>> LocalHost::acquire(const RobotRequest& request, TimePoint deadline) {
  const std::string& name = request.launch.robot;
  const auto found = implementation_->leased(name);
  if (!found) {
    return found.error();
  }
  const auto& robot = *found;
  const TimedWriteLock one(robot->acquiring, deadline);
  if (!one) {
    return fail(ErrorCode::DeadlineExceeded, "another runtime is getting the robot still", name);
  }
  // Bound to the client that asks, so that a secret that was found out serves nobody else.
  const std::string key = request.secret.empty() ? "" : sha256(request.secret + '\n' + request.identity);
  const auto epoch =
      robot->lease.acquire({request.holder, key, request.take_over, request.again, request.term}, deadline);
  if (!epoch) {
    return epoch.error();
  }
  auto launch = implementation_->launch_of(request);
  if (!launch) {
    (void)robot->lease.release(*epoch);
    return launch.error();
  }
  // Nobody works with it: acquire() has waited for that, and nobody has the new epoch yet.
  if (robot->here == nullptr || !(robot->here->launch() == *launch)) {
    robot->here.reset();  // it lets go of the processes, so that the new one can adopt them
    robot->here = std::make_shared<detail::LocalRobot>(
        std::move(*launch), implementation_->hub.for_robot(name), implementation_->connector,
        implementation_->options.name, implementation_->options.clock);
  } else {
    robot->here->part().set_listener({});  // that of the former runtime
    (void)robot->here->part().withdraw();
  }
  segue::log(LogLevel::Info, "host",
             "robot " + quote(name) + " is commanded by runtime " + quote(request.holder) + " (epoch " +
                 std::to_string(*epoch) + ")");
  return detail::make_session(robot, *epoch);
}

}  // namespace segue::distributed
