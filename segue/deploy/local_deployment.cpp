// SPDX-License-Identifier: Apache-2.0
#include <segue/deploy/local_deployment.hpp>

#include <segue/base/text.hpp>
#include <segue/deploy/endpoints.hpp>
#include <segue/deploy/gate.hpp>
#include <segue/deploy/shut_down.hpp>
#include <segue/host/crew.hpp>

#include <algorithm>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

namespace segue::deploy {

namespace {

/// fn(item) for each, in order.
template <class Outcome, class Items, class Function>
std::vector<Outcome> each(const Items& items, Function&& function) {
  std::vector<Outcome> outcomes;
  outcomes.reserve(items.size());
  for (const auto& item : items) {
    outcomes.push_back(function(item));
  }
  return outcomes;
}

}  // namespace

struct LocalDeployment::Implementation {
  Implementation(DeploymentInfo information, host::LocalTaskHost& task_host,
                 std::shared_ptr<link::SharedMemory> memory)
      : info(std::move(information)), host(task_host), endpoints(task_host, std::move(memory)) {}

  [[nodiscard]] model::DeploymentKey key() const { return info.deployment.key(); }
  Result<void> perform(const model::Action& action, TimePoint deadline);
  /// Whether the action is one for this process.
  [[nodiscard]] Result<void> check(const model::Action& action) const;
  /// Runs a hook of a task on a thread that it may keep. `hook` must own what it uses.
  Result<void> run_hook(const model::TaskId& task, TimePoint deadline, std::function<Result<void>()> hook);
  Result<void> run_hook(const model::Action& action);
  [[nodiscard]] Error going(const std::string& subject) const {
    return fail(ErrorCode::Unavailable, "process " + quote(to_string(key())) + " is going down", subject);
  }

  DeploymentInfo info;
  host::LocalTaskHost& host;
  detail::Endpoints endpoints;
  detail::Gate gate;  ///< for all that runs hooks; closed when this goes down
  host::Crew crew{
      [this](const model::Action& action, TimePoint deadline) { return perform(action, deadline); }};
  std::mutex hooks_mutex;
  int last_hook = 0;
  std::map<int, std::function<Result<void>()>> hooks;
  host::Crew hook_crew{[this](const model::Action& action, TimePoint) { return run_hook(action); }};
  host::Crew last{
      [this](const model::Action& action, TimePoint deadline) { return host.perform(action, deadline); },
      detail::kShutDownPatience};
};

Result<void> LocalDeployment::Implementation::check(const model::Action& action) const {
  if (std::holds_alternative<model::DeploymentAction>(action.what)) {
    return fail(ErrorCode::InvalidArgument,
                "a process neither starts nor ends processes; its process server does", action.label());
  }
  const auto* config = std::get_if<model::ConfigAction>(&action.what);
  const bool elsewhere =
      config != nullptr && config->process != key() && !(config->process.is_runtime() && key().is_runtime());
  if (elsewhere) {
    return fail(
        ErrorCode::InvalidArgument,
        "is for process " + quote(to_string(config->process)) + ", and this is " + quote(to_string(key())),
        action.label());
  }
  return {};
}

Result<void> LocalDeployment::Implementation::perform(const model::Action& action, TimePoint deadline) {
  if (auto checked = check(action); !checked) {
    return checked;
  }
  const detail::Gate::Pass pass(gate);
  if (!pass) {
    return going(action.label());
  }
  return host.perform(action, deadline);
}

Result<void> LocalDeployment::Implementation::run_hook(const model::TaskId& task, TimePoint deadline,
                                                       std::function<Result<void>()> hook) {
  model::Action action{0, model::ActionKind::HandOver, model::TaskAction{task}, {}, {}};
  {
    const std::lock_guard lock(hooks_mutex);
    action.id = ++last_hook;
    hooks.emplace(action.id, std::move(hook));
  }
  Result<void> outcome;
  hook_crew.run(std::span(&action, 1), deadline,
                [&](std::vector<host::Completed> ended) { outcome = std::move(ended.front().outcome); });
  return outcome;
}

Result<void> LocalDeployment::Implementation::run_hook(const model::Action& action) {
  std::function<Result<void>()> hook;
  {
    const std::lock_guard lock(hooks_mutex);
    hook = std::move(hooks.extract(action.id).mapped());
  }
  const detail::Gate::Pass pass(gate);
  return pass ? hook() : Result<void>(going(action.task()->str()));
}

LocalDeployment::LocalDeployment(DeploymentInfo info, host::LocalTaskHost& host,
                                 std::shared_ptr<link::SharedMemory> memory)
    : implementation_(std::make_unique<Implementation>(std::move(info), host, std::move(memory))) {
  model::Deployment& own = implementation_->info.deployment;
  own.tasks.clear();
  if (!own.key().is_runtime()) {
    const model::Action deploy{0, model::ActionKind::Deploy, model::DeploymentAction{own}, {}, {}};
    static_cast<void>(host.perform(deploy, TimePoint::max()));
  }
}

LocalDeployment::~LocalDeployment() {
  implementation_->crew.close();
  implementation_->hook_crew.close();
  implementation_->host.set_listener({});
  implementation_->endpoints.close_all();
}

bool LocalDeployment::shut_down(TimePoint deadline) {
  // Half of the time for what is under way, half for what is to be stopped then.
  const TimePoint now = RealClock::instance().now();
  implementation_->gate.close(std::min(deadline, now + (deadline - now) / 2));
  const bool stopped = detail::shut_down(implementation_->host, implementation_->last, deadline);
  const bool left = implementation_->gate.close(deadline);
  implementation_->endpoints.close_all();
  return stopped && left;
}

Result<DeploymentInfo> LocalDeployment::info() {
  return implementation_->info;
}

Result<Snapshot> LocalDeployment::snapshot() {
  host::LocalTaskHost& host = implementation_->host;
  Snapshot snapshot;
  snapshot.network = host.observe();
  snapshot.tasks = host.tasks();
  snapshot.connections = host.connections();
  snapshot.endpoints = implementation_->endpoints.reports();
  snapshot.memory = implementation_->endpoints.usage();
  snapshot.hanging = host.hanging();
  return snapshot;
}

Result<void> LocalDeployment::expect(const model::Network& network) {
  implementation_->host.expect(network);
  return {};
}

void LocalDeployment::begin_all(std::vector<model::Action> actions, TimePoint deadline,
                                host::Completion completed) {
  implementation_->crew.begin(std::move(actions), deadline, std::move(completed));
}

Result<void> LocalDeployment::conclude(const model::Transition& transition, TimePoint /*deadline*/) {
  implementation_->host.conclude(transition);
  return {};
}

Result<std::optional<task::SavedState>> LocalDeployment::save_state(const model::TaskId& task,
                                                                    TimePoint deadline) {
  const auto state = std::make_shared<std::optional<task::SavedState>>();
  auto saved =
      implementation_->run_hook(task, deadline, [&host = implementation_->host, task, deadline, state] {
        auto answer = host.save_state(task, deadline);
        if (!answer) {
          return Result<void>(std::move(answer.error()));
        }
        *state = std::move(*answer);
        return Result<void>();
      });
  if (!saved) {
    return std::move(saved.error());
  }
  return std::move(*state);
}

Result<void> LocalDeployment::restore_state(const model::TaskId& task, const task::SavedState& state,
                                            TimePoint deadline) {
  return implementation_->run_hook(task, deadline, [&host = implementation_->host, task, deadline, state] {
    return host.restore_state(task, state, deadline);
  });
}

Result<model::ComponentModel> LocalDeployment::describe(const model::TaskId& task) {
  return implementation_->host.describe(task);
}

Result<type::Value> LocalDeployment::properties(const model::TaskId& task) {
  return implementation_->host.properties(task);
}

Result<void> LocalDeployment::set_property(const model::TaskId& task, std::string_view path,
                                           const type::Value& value, TimePoint deadline) {
  const detail::Gate::Pass pass(implementation_->gate);
  if (!pass) {
    return implementation_->going(task.str());
  }
  return implementation_->host.set_property(task, path, value, deadline);
}

Result<type::Value> LocalDeployment::call(const model::TaskId& task, std::string_view operation,
                                          const type::Value& arguments, TimePoint deadline) {
  const detail::Gate::Pass pass(implementation_->gate);
  if (!pass) {
    return implementation_->going(task.str());
  }
  return implementation_->host.call(task, operation, arguments, deadline);
}

Result<std::unique_ptr<host::PortReader>> LocalDeployment::open_reader(const model::PortRef& port,
                                                                       std::size_t buffer) {
  return implementation_->host.open_reader(port, buffer);
}

Result<link::MemoryOffer> LocalDeployment::memory(TimePoint /*deadline*/) {
  return implementation_->endpoints.offer();
}

Result<void> LocalDeployment::admit(const link::MemoryOffer& peer, TimePoint /*deadline*/) {
  return implementation_->endpoints.admit(peer);
}

Result<void> LocalDeployment::forget(link::Incarnation peer) {
  return implementation_->endpoints.forget(peer);
}

std::vector<Result<link::OutputOrigin>> LocalDeployment::describe_outputs(
    std::span<const model::PortRef> ports, TimePoint deadline) {
  return each<Result<link::OutputOrigin>>(
      ports, [&](const model::PortRef& port) { return implementation_->endpoints.describe(port, deadline); });
}

std::vector<Result<link::InputPlace>> LocalDeployment::open_inputs(std::span<const OpenInput> inputs,
                                                                   TimePoint deadline) {
  return each<Result<link::InputPlace>>(
      inputs, [&](const OpenInput& input) { return implementation_->endpoints.open(input, deadline); });
}

std::vector<Result<void>> LocalDeployment::attach_outputs(std::span<const AttachOutput> outputs,
                                                          TimePoint deadline) {
  return each<Result<void>>(outputs, [&](const AttachOutput& output) {
    return implementation_->endpoints.attach(output, deadline);
  });
}

std::vector<Result<void>> LocalDeployment::close_endpoints(std::span<const CloseEndpoint> endpoints,
                                                           TimePoint /*deadline*/) {
  return each<Result<void>>(
      endpoints, [&](const CloseEndpoint& endpoint) { return implementation_->endpoints.close(endpoint); });
}

void LocalDeployment::set_listener(Listener listener) {
  if (!listener) {
    implementation_->host.set_listener({});
    return;
  }
  implementation_->host.set_listener([listener = std::move(listener)](const host::HostEvent& event) {
    if (const auto* happened = std::get_if<host::TaskEvent>(&event)) {
      listener(*happened);
    }
  });
}

}  // namespace segue::deploy
