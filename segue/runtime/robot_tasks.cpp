// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/robot_tasks.hpp>

#include <segue/base/file.hpp>
#include <segue/base/input_file.hpp>
#include <segue/base/secret.hpp>
#include <segue/base/text.hpp>
#include <segue/control/deployment_client.hpp>
#include <segue/control/server.hpp>
#include <segue/distributed/lease.hpp>
#include <segue/process_server/process_server.hpp>
#include <segue/runtime/daemon_processes.hpp>
#include <segue/runtime/host_places.hpp>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace segue::runtime::detail {

namespace {

namespace fs = std::filesystem;

/// Time limit for killing processes.
constexpr Duration kForce = std::chrono::seconds(10);
/// How much longer than a lease to wait for one that nobody renews, and how often to look.
constexpr Duration kLeaseGrace = std::chrono::seconds(2);
/// How long it may take until all hosts have been asked again.
constexpr Duration kAskingAgain = std::chrono::seconds(20);
constexpr Duration kLeasePoll = std::chrono::milliseconds(100);

/// Only one runtime may own the processes of a robot: two would remove each other's connections.
Result<Descriptor> lock_robot(const std::string& robot) {
  const auto folder = process_server::process_folder(robot);
  if (!folder) {
    return folder.error();
  }
  const fs::path path = *folder / "runtime.lock";
  Descriptor file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (!file.valid()) {
    return fail(ErrorCode::IoError, "cannot open " + quote(path.string()) + ": " + std::strerror(errno),
                robot);
  }
  if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0) {
    return fail(
        ErrorCode::AlreadyExists,
        "another runtime controls this robot; inspect it with `segue status`, switch it with `segue switch`",
        robot);
  }
  return file;
}

Result<std::unique_ptr<process_server::ProcessService>> connect_daemon() {
  const auto folder = control::socket_folder();
  if (!folder) {
    return folder.error();
  }
  auto connected = control::connect_processes(*folder / "host.sock");
  if (!connected) {
    return fail(ErrorCode::Unavailable, "no process server runs here; start one with `segue host`")
        .because_of(std::move(connected.error()));
  }
  return connected;
}

Result<std::unique_ptr<process_server::ProcessService>> open_processes(const std::string& robot,
                                                                       bool daemon) {
  if (!daemon) {
    auto server = process_server::ProcessServer::create({.zygote = true});
    if (!server) {
      return std::move(server.error());
    }
    return std::unique_ptr<process_server::ProcessService>(std::move(*server));
  }
  auto connected = DaemonProcesses::connect(robot, connect_daemon);
  if (!connected) {
    return std::move(connected.error());
  }
  return std::unique_ptr<process_server::ProcessService>(std::move(*connected));
}

Result<process_server::Launch> launch_of(const model::Robot& robot, const EmbeddedOptions& options) {
  process_server::Launch launch;
  launch.robot = robot.name;
  launch.libraries = robot.libraries;
  for (const auto& pattern : robot.models) {
    for (const auto& file : glob_files(robot.folder / pattern)) {
      launch.models.push_back(fs::absolute(file).string());
    }
  }
  launch.stand_in = options.stand_in;
  launch.only_stand_ins = options.only_stand_ins;
  launch.log_level = to_string(options.log_level);
  if (has_other_hosts(robot)) launch.peers = peer_addresses(robot);
  if (!options.stand_ins.empty()) {
    auto text = read_input_file(options.stand_ins);
    if (!text) {
      return std::move(text.error());
    }
    launch.stand_ins = std::move(*text);
  }
  return launch;
}

deploy::DeploymentInfo own_info(const model::Robot& robot, sample_link::Incarnation incarnation) {
  deploy::DeploymentInfo info;
  info.robot = robot.name;
  info.pid = ::getpid();
  info.software = SEGUE_VERSION;
  info.incarnation = incarnation;
  return info;
}

fleet::DeployedOptions deployed_options(const model::Robot& robot) {
  fleet::DeployedOptions options;
  for (const auto& host : robot.hosts) {
    if (host.is_local()) {
      options.hosts.push_back(host.name);
    }
  }
  return options;
}

/// One run of a runtime, in the leases that it holds.
std::string holder_name() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0) {
    name.front() = '?';
  }
  const auto began = std::chrono::system_clock::now().time_since_epoch();
  return std::string(name.data()) + "/" + std::to_string(::getpid()) + "/" +
         std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(began).count());
}

/// Component models travel, since the files lie on this computer.
Result<distributed::RobotRequest> robot_request(const process_server::Launch& launch,
                                                const EmbeddedOptions& options) {
  distributed::RobotRequest request;
  request.holder = holder_name();
  request.secret = random_secret();
  request.launch = launch;
  request.launch.models.clear();
  request.take_over = options.take_over;
  if (options.stand_in || options.only_stand_ins) {
    for (const auto& file : launch.models) {
      auto text = read_input_file(file);
      if (!text) {
        return std::move(text.error());
      }
      request.models.push_back({fs::path(file).filename().string(), std::move(*text)});
    }
  }
  return request;
}

}  // namespace

Result<std::unique_ptr<RobotTasks>> RobotTasks::create(const model::Robot& robot,
                                                       const task_host::LibrarySet& libraries,
                                                       const model::ComponentCatalog& catalog,
                                                       task_host::LocalOptions local,
                                                       const EmbeddedOptions& options) {
  std::unique_ptr<RobotTasks> tasks(new RobotTasks(libraries, catalog, std::move(local)));
  if (options.placement == TaskPlacement::Processes) {
    if (auto spread = tasks->spread(robot, catalog, options); !spread) {
      return std::move(spread.error());
    }
  }
  return tasks;
}

Result<void> RobotTasks::spread(const model::Robot& robot, const model::ComponentCatalog& catalog,
                                const EmbeddedOptions& options) {
  auto launch = launch_of(robot, options);
  if (!launch) {
    return std::move(launch.error());
  }
  auto lock = lock_robot(robot.name);
  if (!lock) {
    return std::move(lock.error());
  }
  lock_ = std::move(*lock);
  auto memory = sample_link::SharedMemory::create(launch->memory);
  if (!memory) {
    return std::move(memory.error());
  }
  memory_ = std::move(*memory);
  auto processes = open_processes(robot.name, options.daemon);
  if (!processes) {
    return std::move(processes.error());
  }
  processes_ = std::move(*processes);
  own_ = std::make_unique<deploy::LocalDeployment>(own_info(robot, memory_->incarnation()), local_, memory_);
  deployed_ = std::make_unique<fleet::DeployedTaskHost>(*own_, *processes_, &control::connect_deployment,
                                                        *launch, local_, deployed_options(robot));
  return has_other_hosts(robot) ? reach_hosts(robot, catalog, *launch, options) : Result<void>();
}

Result<void> RobotTasks::reach_hosts(const model::Robot& robot, const model::ComponentCatalog& catalog,
                                     const process_server::Launch& launch, const EmbeddedOptions& options) {
  auto request = robot_request(launch, options);
  if (!request) {
    return std::move(request.error());
  }
  distributed::DistributedOptions distributed;
  distributed.request = std::move(*request);
  distributed.gateways = gateway_settings(robot);
  distributed.stand_in = options.stand_in;
  distributed.only_stand_ins = options.only_stand_ins;
  distributed_ = std::make_unique<distributed::DistributedTaskHost>(*deployed_, host_places(robot), catalog,
                                                                    std::move(distributed));
  // The lease of a runtime that was killed runs out soon. A host that has not been asked since then decides
  // nothing: it may not have been, while another one is being taken over.
  auto& clock = RealClock::instance();
  const TimePoint runs_out = clock.now() + distributed::Lease::kValidity + kLeaseGrace;
  const TimePoint give_up = runs_out + kAskingAgain;
  const auto may_run_out = [&] {
    const auto asked = distributed_->refused_at();
    return clock.now() < give_up && (!asked || *asked < runs_out);
  };
  auto commands = distributed_->commands_all();
  while (!commands && commands.error().code == ErrorCode::AlreadyExists && may_run_out()) {
    clock.sleep_until(clock.now() + kLeasePoll);
    commands = distributed_->commands_all();
  }
  if (!commands) {
    return fail(commands.error().code,
                "the robot cannot be commanded; `segue run --take-over` takes it from the other runtime")
        .because_of(std::move(commands.error()));
  }
  return {};
}

task_host::TaskHost& RobotTasks::host() {
  if (distributed_) {
    return *distributed_;
  }
  return deployed_ ? static_cast<task_host::TaskHost&>(*deployed_) : local_;
}

void RobotTasks::end_processes() {
  if (distributed_) {
    distributed_->end_processes(RealClock::instance().now() + kForce);
  } else if (deployed_) {
    deployed_->end_processes(RealClock::instance().now() + kForce);
  }
}

}  // namespace segue::runtime::detail
