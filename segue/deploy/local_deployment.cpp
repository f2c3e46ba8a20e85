// SPDX-License-Identifier: Apache-2.0
#include <segue/deploy/local_deployment.hpp>

#include <segue/base/text.hpp>
#include <segue/deploy/endpoints.hpp>
#include <segue/deploy/in_flight_guard.hpp>
#include <segue/deploy/shut_down.hpp>
#include <segue/task_host/action_pool.hpp>

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

namespace segue::deploy {

namespace {

/// Hooks keep their deadlines by themselves, and say more about it than whoever waits for them.
constexpr Duration kGrace = std::chrono::milliseconds(10);

/// How long all readers together may take for samples of connections that are closed.
constexpr Duration kReading = std::chrono::seconds(1);

/// function(item) for each, in order.
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
  Implementation(DeploymentInfo information, task_host::LocalTaskHost& task_host,
                 std::shared_ptr<sample_link::SharedMemory> memory)
      : info(std::move(information)), host(task_host), endpoints(task_host, std::move(memory)) {}

  [[nodiscard]] model::DeploymentKey key() const { return info.deployment.key(); }
  Result<void> perform(const model::Action& action, TimePoint deadline);
  /// Whether the action is one for this process.
  [[nodiscard]] Result<void> check(const model::Action& action) const;
  /// Runs a hook of a task on a thread that it keeps where it has not ended by the deadline. `hook` must own
  /// what it uses.
  template <class T>
  Result<T> run_hook(const model::TaskId& task, TimePoint deadline, std::function<Result<T>()> hook);
  [[nodiscard]] Error going() const {
    return fail(ErrorCode::Unavailable, "process " + quote(to_string(key())) + " is going down");
  }

  DeploymentInfo info;
  task_host::LocalTaskHost& host;
  detail::Endpoints endpoints;
  detail::InFlightGuard in_flight;  ///< all that runs hooks; closed when this goes down
  concurrent::ThreadPool threads{"segue-actions", task_host::kActionThreads};
  task_host::ActionPool actions{
      threads, [this](const model::Action& action, TimePoint deadline) { return perform(action, deadline); }};
  /// For the actions of shut_down(), which go on where others are refused.
  task_host::ActionPool last_actions{
      threads,
      [this](const model::Action& action, TimePoint deadline) { return host.carry_out(action, deadline); },
      detail::kShutDownPatience};
};

Result<void> LocalDeployment::Implementation::check(const model::Action& action) const {
  if (std::holds_alternative<model::DeploymentAction>(action.what)) {
    return fail(ErrorCode::InvalidArgument,
                "a process neither starts nor ends processes; its process server does");
  }
  const auto* config = std::get_if<model::ConfigAction>(&action.what);
  const bool elsewhere =
      config != nullptr && config->process != key() && !(config->process.is_runtime() && key().is_runtime());
  if (elsewhere) {
    return fail(ErrorCode::InvalidArgument, "is for process " + quote(to_string(config->process)) +
                                                ", and this is " + quote(to_string(key())));
  }
  return {};
}

Result<void> LocalDeployment::Implementation::perform(const model::Action& action, TimePoint deadline) {
  if (auto checked = check(action); !checked) {
    return checked;
  }
  const detail::InFlightGuard::Pass pass(in_flight);
  if (!pass) {
    return going();
  }
  return host.carry_out(action, deadline);
}

template <class T>
Result<T> LocalDeployment::Implementation::run_hook(const model::TaskId& task, TimePoint deadline,
                                                    std::function<Result<T>()> hook) {
  const auto outcome = std::make_shared<Result<T>>(fail(ErrorCode::Internal, "was not run"));
  auto ran = threads.run([outcome, hook = std::move(hook)] { *outcome = hook(); }, deadline + kGrace);
  if (!ran) {
    return std::move(ran.error()).about(task.str());
  }
  return std::move(*outcome);
}

LocalDeployment::LocalDeployment(DeploymentInfo info, task_host::LocalTaskHost& host,
                                 std::shared_ptr<sample_link::SharedMemory> memory)
    : implementation_(std::make_unique<Implementation>(std::move(info), host, std::move(memory))) {
  model::Deployment& own = implementation_->info.deployment;
  own.tasks.clear();
  if (!own.key().is_runtime()) {
    const model::Action deploy{0, model::ActionKind::Deploy, model::DeploymentAction{own}, {}, {}};
    static_cast<void>(host.carry_out(deploy, TimePoint::max()));
  }
}

LocalDeployment::~LocalDeployment() {
  implementation_->actions.close();
  implementation_->threads.close();
  implementation_->host.set_listener({});
  implementation_->endpoints.close_all();
}

bool LocalDeployment::shut_down(TimePoint deadline) {
  // Half of the time is for calls that are under way, half for tasks that are stopped then.
  const TimePoint now = RealClock::instance().now();
  implementation_->in_flight.close(std::min(deadline, now + (deadline - now) / 2));
  const bool stopped = detail::shut_down(implementation_->host, implementation_->last_actions, deadline);
  const bool left = implementation_->in_flight.close(deadline);
  implementation_->endpoints.close_all();
  return stopped && left;
}

Result<DeploymentInfo> LocalDeployment::info() {
  return implementation_->info;
}

Result<Snapshot> LocalDeployment::snapshot() {
  task_host::LocalTaskHost& host = implementation_->host;
  Snapshot snapshot;
  snapshot.network = host.observe();
  snapshot.tasks = host.tasks();
  snapshot.connections = host.connections();
  snapshot.endpoints = implementation_->endpoints.reports();
  snapshot.memory = implementation_->endpoints.usage();
  for (const auto& [task, why] : host.hanging()) {
    snapshot.hanging.push_back(task);
  }
  return snapshot;
}

Result<void> LocalDeployment::expect(const model::Network& network) {
  implementation_->host.expect(network);
  return {};
}

void LocalDeployment::begin_all(std::vector<model::Action> actions, TimePoint deadline,
                                task_host::Completion completed) {
  implementation_->actions.begin(std::move(actions), deadline, std::move(completed));
}

Result<void> LocalDeployment::arm_commit(const ArmCommit& what, TimePoint /*deadline*/) {
  const auto gate = implementation_->host.arm_commit(what.page->word(what.number), what.number, what.within);
  implementation_->endpoints.end_at(gate, what.endpoints);
  return {};
}

Result<void> LocalDeployment::settle(TimePoint /*deadline*/) {
  implementation_->host.settle();
  implementation_->endpoints.settle();
  return {};
}

Result<void> LocalDeployment::conclude(const model::Transition& transition, TimePoint /*deadline*/) {
  implementation_->host.conclude(transition);
  return {};
}

Result<std::optional<task::SavedState>> LocalDeployment::save_state(const model::TaskId& task,
                                                                    TimePoint deadline) {
  return implementation_->run_hook<std::optional<task::SavedState>>(
      task, deadline, [this, task, deadline] { return TaskForwarder::save_state(task, deadline); });
}

Result<void> LocalDeployment::restore_state(const model::TaskId& task, const task::SavedState& state,
                                            TimePoint deadline) {
  return implementation_->run_hook<void>(task, deadline, [this, task, deadline, state] {
    return TaskForwarder::restore_state(task, state, deadline);
  });
}

Result<task_host::TaskPlace> LocalDeployment::find_place(const model::TaskId& task,
                                                         task_host::Purpose purpose) const {
  auto& self = *implementation_;
  if (purpose == task_host::Purpose::Observe) {
    return task_host::place_at(self.host, task);
  }
  const auto pass = std::make_shared<detail::InFlightGuard::Pass>(self.in_flight);
  if (!*pass) {
    return self.going();
  }
  return task_host::TaskPlace{{pass, &self.host}, task};
}

Result<sample_link::MemoryOffer> LocalDeployment::memory(TimePoint /*deadline*/) {
  return implementation_->endpoints.offer();
}

Result<void> LocalDeployment::admit(const sample_link::MemoryOffer& peer, TimePoint /*deadline*/) {
  return implementation_->endpoints.admit(peer);
}

Result<void> LocalDeployment::forget(sample_link::Incarnation peer) {
  return implementation_->endpoints.forget(peer);
}

std::vector<Result<sample_link::OutputOrigin>> LocalDeployment::describe_outputs(
    std::span<const model::PortRef> ports, TimePoint deadline) {
  return each<Result<sample_link::OutputOrigin>>(
      ports, [&](const model::PortRef& port) { return implementation_->endpoints.describe(port, deadline); });
}

std::vector<Result<sample_link::InputPlace>> LocalDeployment::open_inputs(std::span<const OpenInput> inputs,
                                                                          TimePoint deadline) {
  return each<Result<sample_link::InputPlace>>(
      inputs, [&](const OpenInput& input) { return implementation_->endpoints.open(input, deadline); });
}

std::vector<Result<void>> LocalDeployment::attach_outputs(std::span<const AttachOutput> outputs,
                                                          TimePoint deadline) {
  return each<Result<void>>(outputs, [&](const AttachOutput& output) {
    return implementation_->endpoints.attach(output, deadline);
  });
}

std::vector<Result<void>> LocalDeployment::close_endpoints(std::span<const CloseEndpoint> endpoints,
                                                           TimePoint deadline) {
  const TimePoint readers = std::min(deadline, RealClock::instance().now() + kReading);
  return each<Result<void>>(endpoints, [&](const CloseEndpoint& endpoint) {
    return implementation_->endpoints.close(endpoint, readers);
  });
}

void LocalDeployment::set_listener(Listener listener) {
  if (!listener) {
    implementation_->host.set_listener({});
    return;
  }
  implementation_->host.set_listener([listener = std::move(listener)](const task_host::HostEvent& event) {
    if (const auto* happened = std::get_if<task_host::TaskEvent>(&event)) {
      listener(*happened);
    }
  });
}

}  // namespace segue::deploy
