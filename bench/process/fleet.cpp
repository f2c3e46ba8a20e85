// SPDX-License-Identifier: Apache-2.0
#include "fleet.hpp"

#include "../support/chain.hpp"

#include <segue/control/deployment_client.hpp>
#include <segue/deploy/local_deployment.hpp>
#include <segue/distributed/distributed_task_host.hpp>
#include <segue/fleet/deployed_task_host.hpp>
#include <segue/model/files.hpp>
#include <segue/process_server/process_server.hpp>
#include <segue/runtime/host_places.hpp>
#include <segue/task_host/local_task_host.hpp>

#include <cstdlib>
#include <filesystem>

#include <unistd.h>

namespace bench {
namespace {

using namespace segue;
using model::Action;
using model::ActionKind;

constexpr const char* kLibrary = "segue_components_bench";

TimePoint soon() {
  return RealClock::instance().now() + std::chrono::seconds(30);
}

template <class T>
T must(Result<T> result) {
  if (!result) bench::require(std::move(result.error()));
  return std::move(*result);
}

/// The folder of sockets and logs of this process and its children.
class Folder {
 public:
  Folder() : path_((std::filesystem::temp_directory_path() / "segue-bench-XXXXXX").string()) {
    if (::mkdtemp(path_.data()) == nullptr) std::exit(1);
    ::setenv("XDG_RUNTIME_DIR", path_.c_str(), 1);
    ::setenv("SEGUE_LIBRARY_PATH", SEGUE_BENCH_LIBRARIES, 1);
    ::setenv("SEGUE_DEPLOYMENT", SEGUE_BENCH_DEPLOYMENT, 1);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

 private:
  std::string path_;
};

class RealFleet : public Fleet {
 public:
  explicit RealFleet(bool zygote) {
    process_server::ProcessServerOptions options;
    options.zygote = zygote;
    if (zygote) options.zygote_libraries = {kLibrary};
    processes_ = must(process_server::ProcessServer::create(options));
    memory_ = must(sample_link::SharedMemory::create());
    launch_.robot = "bench";
    launch_.libraries = {kLibrary};
    launch_.log_level = "error";
    deploy::DeploymentInfo info;
    info.robot = launch_.robot;
    info.pid = ::getpid();
    info.software = SEGUE_VERSION;
    info.incarnation = memory_->incarnation();
    own_ = std::make_unique<deploy::LocalDeployment>(info, local_, memory_);
    deployed_ = std::make_unique<fleet::DeployedTaskHost>(*own_, *processes_, &control::connect_deployment,
                                                          launch_, local_);
  }
  ~RealFleet() override { deployed_->end_processes(soon()); }

  task_host::TaskHost& host() override { return *deployed_; }

 protected:
  [[nodiscard]] fleet::DeployedTaskHost& deployed() { return *deployed_; }
  [[nodiscard]] const model::ComponentCatalog& catalog() const { return catalog_; }
  [[nodiscard]] const process_server::Launch& launch() const { return launch_; }

 private:
  Folder folder_;
  process_server::Launch launch_;
  task_host::LibrarySet libraries_;
  model::ComponentCatalog catalog_;
  task_host::LocalTaskHost local_{libraries_, catalog_};
  std::shared_ptr<sample_link::SharedMemory> memory_;
  std::unique_ptr<process_server::ProcessServer> processes_;
  std::unique_ptr<deploy::LocalDeployment> own_;
  std::unique_ptr<fleet::DeployedTaskHost> deployed_;
};

class RemoteFleet final : public RealFleet {
 public:
  explicit RemoteFleet(const runtime::HostEntries& hosts) : RealFleet(false) {
    std::string text = "robot: bench\nhosts:\n";
    for (const auto& [name, entry] : hosts)
      text += "  " + name + ": " + entry + "\n";
    Diagnostics diagnostics;
    const auto robot = model::read_robot(text, "robot.yaml", diagnostics);
    if (!robot) require(diagnostics.to_error());
    distributed::DistributedOptions options;
    options.request.holder = "bench/" + std::to_string(::getpid());
    options.request.launch = launch();
    options.gateways = runtime::gateway_settings(*robot);
    distributed_ = std::make_unique<distributed::DistributedTaskHost>(
        deployed(), runtime::host_places(*robot), catalog(), std::move(options));
    require(distributed_->commands_all());
  }
  ~RemoteFleet() override { distributed_->end_processes(soon()); }

  task_host::TaskHost& host() override { return *distributed_; }

 private:
  std::unique_ptr<distributed::DistributedTaskHost> distributed_;
};

Action action(ActionKind kind) {
  Action made;
  made.kind = kind;
  return made;
}

}  // namespace

std::unique_ptr<Fleet> Fleet::open(bool zygote) {
  return std::make_unique<RealFleet>(zygote);
}

std::unique_ptr<Fleet> Fleet::open_on(const runtime::HostEntries& hosts) {
  return std::make_unique<RemoteFleet>(hosts);
}

void Fleet::perform(const std::vector<Action>& actions) {
  for (auto& outcome : host().perform_all(actions, soon()))
    require(outcome);
}

void Fleet::run(const std::string& process, const std::vector<std::string>& tasks,
                const std::string& component) {
  std::vector<Action> placed;
  for (const std::string& task : tasks)
    placed.push_back(place(task, component, here(process)));
  perform(placed);
  for (const ActionKind kind : {ActionKind::Configure, ActionKind::Start}) {
    std::vector<Action> changes;
    for (const std::string& task : tasks)
      changes.push_back(on_task(kind, task));
    perform(changes);
  }
}

Action on_task(ActionKind kind, const std::string& task) {
  Action made = action(kind);
  made.what = model::TaskAction{model::TaskId(task)};
  return made;
}

Action on_process(ActionKind kind, const model::DeploymentKey& process) {
  Action made = action(kind);
  model::Deployment deployment;
  deployment.host = process.host;
  deployment.process = process.process;
  made.what = model::DeploymentAction{deployment};
  return made;
}

Action on_connection(ActionKind kind, const std::string& from, const std::string& to) {
  Action made = action(kind);
  model::Connection connection;
  connection.from = {model::TaskId(from), "fixed_out"};
  connection.to = {model::TaskId(to), "fixed_in"};
  connection.policy = {BufferKind::Data, 1, Transport::Automatic, true};
  made.what = model::ConnectionAction{connection};
  return made;
}

Action place(const std::string& task, const std::string& component, const model::DeploymentKey& process) {
  Action made = action(ActionKind::ApplyConfig);
  model::Task definition;
  definition.id = model::TaskId(task);
  definition.component = model::ComponentName(component);
  if (component == "bench::Producer") {
    // One sample, then none for the duration of any benchmark.
    definition.activity = Activity{Trigger::Periodic, std::chrono::hours(1), {}, 0, {}, {}, false};
  }
  made.what = model::ConfigAction{definition, process, task};
  return made;
}

model::DeploymentKey here(const std::string& process) {
  return {model::kLocalHost, model::ProcessName(process)};
}

}  // namespace bench
