// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/runtime.hpp>

#include <segue/base/text.hpp>
#include <segue/runtime/robot_snapshot.hpp>
#include <segue/runtime/runtime_implementation.hpp>
#include <segue/type/json.hpp>

#include <array>

namespace segue::runtime {

namespace {

/// A value for a message, however large it is.
std::string short_text(const type::Value& value) {
  if (value.is_string()) {
    return quote(value.as_string());
  }
  const std::string quoted = quote(type::to_json(value, -1));
  return quoted.substr(1, quoted.size() - 2);
}

}  // namespace

std::string_view to_string(RuntimeState state) {
  static constexpr std::array<std::string_view, 3> kNames = {"idle", "executing", "failed"};
  return kNames.at(static_cast<std::size_t>(state));
}

std::string_view to_string(EventKind kind) {
  static constexpr std::array<std::string_view, 27> kNames = {"request_accepted",
                                                              "transition_started",
                                                              "action_done",
                                                              "action_failed",
                                                              "transition_committed",
                                                              "transition_done",
                                                              "transition_failed",
                                                              "transition_undone",
                                                              "request_refused",
                                                              "request_superseded",
                                                              "task_state",
                                                              "process",
                                                              "difference",
                                                              "belief_reset",
                                                              "repair",
                                                              "given_up",
                                                              "prepared",
                                                              "journal",
                                                              "host_lost",
                                                              "host_found",
                                                              "files",
                                                              "lease",
                                                              "request_cancelled",
                                                              "halt",
                                                              "pool",
                                                              "units",
                                                              "property"};
  return kNames.at(static_cast<std::size_t>(kind));
}

Runtime::Runtime(std::string name, task_host::TaskHost& host, const model::ComponentCatalog& catalog)
    : Runtime(std::move(name), host, catalog, RuntimeOptions()) {}

Runtime::Runtime(std::string name, task_host::TaskHost& host, const model::ComponentCatalog& catalog,
                 RuntimeOptions options)
    : implementation_(std::make_unique<Implementation>(std::move(name), host, catalog, std::move(options))) {}

Runtime::~Runtime() = default;

const std::string& Runtime::name() const {
  return implementation_->name;
}

Diagnostics Runtime::add_controller(model::Network network) {
  return implementation_->add(std::move(network));
}

Diagnostics Runtime::load(const ControllerSet& set) {
  return implementation_->load(set);
}

std::future<ApplyResult> Runtime::apply(ControllerSet set, RequestOptions options) {
  return implementation_->apply(std::move(set), std::move(options));
}

std::vector<LoadedFile> Runtime::files() const {
  return implementation_->controllers.files();
}

std::string Runtime::version() const {
  return implementation_->belief.version();
}

std::vector<model::NetworkName> Runtime::controllers() const {
  return implementation_->controllers.names();
}

std::optional<model::Network> Runtime::controller(const model::NetworkName& name) const {
  return implementation_->controllers.known(name);
}

std::vector<std::string> Runtime::transitions() const {
  return implementation_->controllers.transitions();
}

Result<model::Transition> Runtime::transition(const std::string& name) const {
  return implementation_->controllers.transition(name);
}

std::shared_future<HaltResult> Runtime::halt(HaltRequest request) {
  return implementation_->halts.begin(std::move(request));
}

Result<void> Runtime::release(const std::string& who) {
  return implementation_->halts.release(who);
}

std::optional<Halted> Runtime::halted() const {
  return implementation_->halts.halted();
}

AcceptedRequest Runtime::accept(Request request, RequestOptions options) {
  return implementation_->accept(std::move(request), std::move(options));
}

AcceptedRequest Runtime::repair(RequestOptions options) {
  return implementation_->repair(std::move(options));
}

RobotSnapshot Runtime::snapshot() const {
  return implementation_->supervisor.snapshot();
}

std::future<SwitchResult> Runtime::request(Request request, RequestOptions options) {
  return accept(std::move(request), std::move(options)).result;
}

SwitchResult Runtime::switch_to(Request request, RequestOptions options) {
  return this->request(std::move(request), std::move(options)).get();
}

std::future<SwitchResult> Runtime::take_down(std::string who) {
  return implementation_
      ->accept(model::Network(), {.who = std::move(who)}, {.although_halted = true, .ends_pools = true})
      .result;
}

Result<std::future<SwitchResult>> Runtime::cancel(std::uint64_t request, std::string who) {
  return implementation_->cancel(request, std::move(who));
}

std::vector<OpenRequest> Runtime::open_requests() const {
  return implementation_->queue.open();
}

Result<model::Transition> Runtime::plan(const Request& request, const RequestOptions& options) const {
  auto plan =
      implementation_->switching.plan(implementation_->belief.starting_point().network, request, options);
  if (!plan) {
    return std::move(plan.error());
  }
  return std::move(plan->transition);
}

Result<PlannedSwitch> Runtime::preview(const Request& request, const RequestOptions& options) const {
  const auto& robot = *implementation_;
  const auto current = robot.belief.starting_point().network;
  auto plan = robot.switching.plan(current, request, options);
  if (!plan) {
    return std::move(plan.error());
  }
  PlannedSwitch planned{.transition = std::move(plan->transition), .changes = {}, .expected = {}};
  planned.changes =
      model::changes(belief(), robot.host.condensed(std::move(plan->controller)), kMostPlannedChanges);
  const auto known = robot.journal.known();
  if (known && !known->actions.empty()) {
    planned.expected = solve::estimate(current, planned.transition, *known);
  }
  return planned;
}

RuntimeState Runtime::state() const {
  return implementation_->queue.state();
}

model::Network Runtime::belief() const {
  return implementation_->host.condensed(implementation_->belief.controller());
}

void Runtime::reset_belief(std::optional<model::Network> network) {
  implementation_->switching.reset(std::move(network));
}

std::vector<std::string> Runtime::observed_differences() const {
  if (state() == RuntimeState::Executing) {
    return {};
  }
  return implementation_->switching.differences_from(implementation_->host.observe());
}

std::future<std::vector<Readiness>> Runtime::prepare(std::vector<model::NetworkName> controllers) {
  return implementation_->prepare(std::move(controllers), 0);
}

std::vector<Readiness> Runtime::readiness() const {
  return implementation_->standby_requests.readiness();
}

Result<void> Runtime::set_property(const model::TaskId& task, std::string_view property,
                                   const type::Value& value, const std::string& who, TimePoint deadline) {
  auto done = implementation_->host.set_property(task, property, value, deadline);
  if (done) {
    implementation_->log.add(
        EventKind::Property, task.str(),
        (who.empty() ? "somebody" : who) + " set " + std::string(property) + " to " + short_text(value));
  }
  return done;
}

Result<type::Value> Runtime::call(const model::TaskId& task, std::string_view operation,
                                  const type::Value& arguments, const Wait& wait) {
  return implementation_->pools.call(task, operation, arguments, wait);
}

std::vector<PoolReport> Runtime::pools() const {
  return implementation_->options.pools.empty()
             ? std::vector<PoolReport>()
             : implementation_->pools.report(implementation_->host.tasks());
}

std::vector<UnresolvedFault> Runtime::unresolved() const {
  return implementation_->faults.unresolved();
}

std::vector<UnresolvedFault> Runtime::in_repair() const {
  return implementation_->faults.in_repair();
}

std::vector<SwitchResult> Runtime::history() const {
  return implementation_->history.all();
}

const std::filesystem::path& Runtime::journal() const {
  return implementation_->options.journal;
}

std::vector<Event> Runtime::events(std::uint64_t after, const Wait& wait) const {
  return implementation_->log.after(after, wait);
}

const model::ComponentCatalog& Runtime::components() const {
  return implementation_->catalog;
}

task_host::TaskHost& Runtime::host() {
  return implementation_->host;
}

ServedRuntime& Runtime::served() {
  return implementation_->served;
}

}  // namespace segue::runtime
