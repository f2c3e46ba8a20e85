// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>

#include <support/fake_world.hpp>

#include <algorithm>
#include <limits>

namespace segue::deploy::testing {

namespace {

Error injected(ErrorCode code) {
  return fail(code, "injected");
}

bool same_place(const EndpointReport& a, const EndpointReport& b) {
  return a.place.reader == b.place.reader && a.place.offset == b.place.offset &&
         a.place.generation == b.place.generation;
}

}  // namespace

FakeWorld::FakeWorld() : own_(std::make_shared<FakeProcess>()) {
  own_->incarnation = std::numeric_limits<sample_link::Incarnation>::max();  // no other process gets as far
  own_->info.pid = 1;
}

FakeWorld::~FakeWorld() {
  for (auto& each : later_) {
    each.wait();
  }
}

void FakeWorld::set_fault(Fault fault) {
  const Lock lock(mutex);
  fault_ = fault;
  count_ = 0;
}

void FakeWorld::clear_fault() {
  const Lock lock(mutex);
  fault_.reset();
}

bool FakeWorld::fault_happened() const {
  const Lock lock(mutex);
  return happened_;
}

int FakeWorld::calls(const std::string& what) const {
  const Lock lock(mutex);
  const auto found = calls_.find(what);
  return found == calls_.end() ? 0 : found->second;
}

void FakeWorld::on_call(std::function<void(const std::string&, const FakePtr&)> see) {
  const Lock lock(mutex);
  see_ = std::move(see);
}

void FakeWorld::change(const std::function<void()>& what) {
  const Lock lock(mutex);
  what();
}

FakePtr FakeWorld::find(const std::string& process) const {
  const Lock lock(mutex);
  const auto found = std::find_if(processes_.begin(), processes_.end(),
                                  [&](const auto& item) { return item.first.process.str() == process; });
  return found == processes_.end() ? nullptr : found->second;
}

FakePtr FakeWorld::find(const model::DeploymentKey& key) const {
  const Lock lock(mutex);
  const auto found = processes_.find(key);
  return found == processes_.end() ? nullptr : found->second;
}

std::vector<FakePtr> FakeWorld::running() const {
  const Lock lock(mutex);
  std::vector<FakePtr> running;
  for (const auto& [key, process] : processes_) {
    running.push_back(process);
  }
  return running;
}

FakePtr FakeWorld::of(sample_link::Incarnation incarnation) const {
  if (own_->incarnation == incarnation) {
    return own_;
  }
  for (const auto& [key, process] : processes_) {
    if (process->incarnation == incarnation) {
      return process;
    }
  }
  return nullptr;
}

model::Network FakeWorld::truth() const {
  auto all = running();
  all.push_back(own_);
  const Lock lock(mutex);
  model::Network network;
  for (const auto& process : all) {
    model::Deployment deployment = process->deployment;
    deployment.deployer = process->hangs ? "unknown" : deployment.deployer;
    for (const auto& [id, task] : process->tasks) {
      deployment.tasks.push_back({id, id.str()});
      network.tasks.push_back(task);
      if (process->hangs || process->hanging.contains(id)) {
        network.tasks.back().state = TaskState::Fatal;
      }
    }
    if (process != own_) {
      network.deployments.push_back(deployment);
    }
    if (process->hangs) {
      continue;
    }
    for (const auto& connection : process->connections) {
      if (process->carries(connection)) {
        network.connections.push_back(connection);
      }
    }
    for (const auto& endpoint : process->endpoints) {
      const auto peer = of(endpoint.peer);
      const bool whole =
          endpoint.side == Side::Output && peer != nullptr && !peer->hangs &&
          std::any_of(peer->endpoints.begin(), peer->endpoints.end(), [&](const EndpointReport& other) {
            return other.side == Side::Input && same_place(endpoint, other) && peer->carries(other);
          });
      if (whole && process->carries(endpoint)) {
        network.connections.push_back(endpoint.connection);
      }
    }
  }
  return network;
}

std::size_t FakeWorld::orphaned_endpoints() const {
  return orphans().size();
}

std::vector<std::string> FakeWorld::orphans() const {
  auto all = running();
  all.push_back(own_);
  const Lock lock(mutex);
  std::vector<std::string> found;
  for (const auto& process : all) {
    for (const auto& endpoint : process->endpoints) {
      const auto peer = of(endpoint.peer);
      const bool whole =
          peer != nullptr &&
          std::any_of(peer->endpoints.begin(), peer->endpoints.end(), [&](const EndpointReport& other) {
            return other.side != endpoint.side && same_place(endpoint, other);
          });
      if (!whole) {
        found.push_back(to_string(endpoint.connection) + " (its " +
                        (endpoint.side == Side::Output ? "output" : "input") + " on process " +
                        process->deployment.process.str() + ", " +
                        (peer == nullptr ? "whose peer is gone" : "alone") +
                        (endpoint.carries ? ")" : ", carries nothing)"));
      }
    }
  }
  return found;
}

FakePtr FakeWorld::add_running(const std::string& process) {
  process_server::Launch launch;
  launch.deployment.process = model::ProcessName(process);
  auto made = start(launch);
  const Lock lock(mutex);
  made->info.adopted = true;
  return made;
}

FakePtr FakeWorld::start(const process_server::Launch& launch) {
  const auto process = std::make_shared<FakeProcess>();
  bool dies = false;
  {
    const Lock lock(mutex);
    ++lives_;
    process->deployment = launch.deployment;
    process->incarnation = static_cast<sample_link::Incarnation>(lives_);
    process->info.robot = "robot";
    process->info.key = launch.deployment.key();
    process->info.pid = 100 + lives_;
    process->info.socket = "/fake/" + launch.deployment.process.str() + '.' + std::to_string(lives_);
    processes_[launch.deployment.key()] = process;
    dies = next_dies_.exchange(false);
  }
  if (dies) {
    kill(process, 11);
  }
  return process;
}

void FakeWorld::kill(const FakePtr& process, int signal, bool requested) {
  std::function<void()> gone;
  {
    const Lock lock(mutex);
    if (process == own_ || !std::exchange(process->alive, false)) {
      return;
    }
    const auto found = processes_.find(process->info.key);
    if (found != processes_.end() && found->second == process) {
      processes_.erase(found);
    }
    gone = std::exchange(process->gone, nullptr);
  }
  later([this, process, gone, signal, requested] {
    if (gone) {
      gone();
    }
    process_server::ProcessInfo info = process->info;
    info.exit = process_server::ExitReason{};
    info.exit->signal = signal;
    info.exit->requested = requested;
    process_server::ProcessService::Listener listener;
    {
      const Lock lock(mutex);
      listener = exit_listener;
    }
    if (listener) {
      listener(info);
    }
  });
}

void FakeWorld::cut(const FakePtr& process) {
  std::function<void()> gone;
  {
    const Lock lock(mutex);
    gone = std::exchange(process->gone, nullptr);
  }
  later([gone] {
    if (gone) {
      gone();
    }
  });
}

void FakeWorld::later(std::function<void()> what) {
  auto started = std::async(std::launch::async, std::move(what));
  const Lock lock(mutex);
  later_.push_back(std::move(started));
}

void FakeWorld::tell(const FakePtr& process, const task_host::TaskEvent& event) {
  DeploymentService::Listener listener;
  {
    const Lock lock(mutex);
    listener = process->listener;
  }
  if (listener) {
    listener(event);
  }
}

FakeWorld::Verdict FakeWorld::judge(const std::string& what, const FakePtr& process) {
  std::function<void(const std::string&, const FakePtr&)> see;
  {
    const Lock lock(mutex);
    see = see_;
  }
  if (see) {
    see(what, process);
  }
  Verdict verdict;
  bool die_first = false;
  {
    const Lock lock(mutex);
    ++calls_[what];
    ++count_;
    const bool hit = fault_ && fault_->at == count_;
    happened_ = happened_ || hit;
    const bool mortal = process != nullptr && process != own_;
    const FaultKind kind = !hit ? FaultKind::Fail : fault_->kind;
    if (hit && (kind == FaultKind::Fail || (!mortal && kind != FaultKind::LoseAnswer))) {
      verdict = {injected(ErrorCode::Internal), false, false};
    } else if (hit && kind == FaultKind::LoseAnswer) {
      verdict = {injected(ErrorCode::DeadlineExceeded), true, false};
    } else if (hit && kind == FaultKind::Hang) {
      process->hangs = true;
    } else if (hit) {
      verdict.die_afterwards = kind == FaultKind::DieAfterwards;
      die_first = kind == FaultKind::Die;
    }
  }
  if (die_first) {
    kill(process);
  }
  const Lock lock(mutex);
  if (process != nullptr && (!process->alive || process->hangs)) {
    verdict.answer = injected(process->alive ? ErrorCode::DeadlineExceeded : ErrorCode::Unavailable);
    verdict.take_effect = false;
  }
  return verdict;
}

Result<process_server::ProcessInfo> FakeProcesses::start(const process_server::Launch& launch,
                                                         TimePoint /*deadline*/) {
  const auto verdict = world_.judge("start", nullptr);
  if (verdict.take_effect) {
    const auto same = world_.find(launch.deployment.key());
    if (same != nullptr && !same->other_version) {
      return fail(ErrorCode::AlreadyExists, "runs already");
    }
    if (same != nullptr) {
      world_.kill(same, 15);
    }
    const auto process = world_.start(launch);
    if (!verdict.answer) {
      return process->info;
    }
  }
  return *verdict.answer;
}

Result<process_server::ExitReason> FakeProcesses::stop(const std::string& /*robot*/,
                                                       const model::DeploymentKey& key,
                                                       TimePoint /*deadline*/) {
  return end("stop", key, 15);
}

Result<process_server::ExitReason> FakeProcesses::kill(const std::string& /*robot*/,
                                                       const model::DeploymentKey& key,
                                                       TimePoint /*deadline*/) {
  return end("kill", key, 9);
}

Result<process_server::ExitReason> FakeProcesses::end(const std::string& how, const model::DeploymentKey& key,
                                                      int signal) {
  const auto verdict = world_.judge(how, nullptr);
  if (verdict.take_effect) {
    const auto process = world_.find(key);
    if (process == nullptr) {
      return fail(ErrorCode::NotFound, "no such process");
    }
    if (!world_.survives()) {
      world_.kill(process, process->crashed_by != 0 ? process->crashed_by : signal, true);
    }
    if (!verdict.answer) {
      process_server::ExitReason reason;
      reason.requested = true;
      reason.signal = process->crashed_by;
      reason.killed = process->hangs || how == "kill";
      return reason;
    }
  }
  return *verdict.answer;
}

Result<std::vector<process_server::ProcessInfo>> FakeProcesses::processes(const std::string& /*robot*/) {
  const auto verdict = world_.judge("processes", nullptr);
  if (verdict.answer) {
    return *verdict.answer;
  }
  std::vector<process_server::ProcessInfo> infos;
  for (const auto& process : world_.running()) {
    infos.push_back(process->info);
  }
  return infos;
}

void FakeProcesses::set_listener(Listener listener) {
  const Lock lock(world_.mutex);
  world_.exit_listener = std::move(listener);
}

fleet::Connector connector(FakeWorld& world) {
  return [&world](const std::filesystem::path& socket, TimePoint /*deadline*/,
                  std::function<void()> gone) -> Result<ConnectedDeployment> {
    FakePtr process;
    for (const auto& other : world.running()) {
      if (other->info.socket == socket) {
        process = other;
      }
    }
    const auto verdict = world.judge("connect_deployment", process);
    if (process == nullptr) {
      return fail(ErrorCode::Unavailable, "nobody answers");
    }
    if (process->other_version) {
      return fail(ErrorCode::InvalidState, "it is of version 0.0.9, this is 0.1.0");
    }
    if (verdict.answer) {
      return *verdict.answer;
    }
    world.change([&] { process->gone = std::move(gone); });
    auto service = std::make_unique<FakeService>(world, process);
    auto info = service->info();
    if (!info) {
      return std::move(info.error());
    }
    return ConnectedDeployment{std::move(service), std::move(*info)};
  };
}

}  // namespace segue::deploy::testing
