// SPDX-License-Identifier: Apache-2.0
//
// Runs with the engine for task networks: of missions concurrently, and of networks from files in either
// mode.
#include <segue/base/text.hpp>
#include <segue/convert/concurrent_run.hpp>
#include <segue/convert/in_sequence.hpp>
#include <segue/mission_run/implementation.hpp>
#include <segue/mission_run/run_control.hpp>
#include <segue/task_network/concurrent_engine.hpp>
#include <segue/task_network/critical_path.hpp>
#include <segue/task_network/priority.hpp>
#include <segue/task_network/sequential.hpp>

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>

namespace segue::mission_run::detail {

namespace {

using type::Value;

/// How long all that counted took together.
Duration time_of_all(const task_network::RunResult& result) {
  Duration sum{};
  for (const task_network::NodeResult& node : result.nodes) {
    if (node.status == task_network::NodeStatus::Done) sum += node.ended - node.started;
  }
  return sum;
}

/// The part that both kinds have: a network, its order, and the result of each node.
class NetworkRun : public FinishedRun {
 public:
  [[nodiscard]] bool as_written() const override { return false; }

  [[nodiscard]] std::vector<RunRow> rows(std::size_t most) const override {
    std::vector<RunRow> rows;
    for (const task_network::NodeId node : listed_) {
      if (rows.size() == most) break;
      rows.push_back(row(node));
    }
    return rows;
  }

  [[nodiscard]] const task_network::RunSummary& comparison() override { return comparison_; }
  [[nodiscard]] Value to_value() override {
    return task_network::to_value(network(), result(), *waits_, listed_, comparison_);
  }

 protected:
  [[nodiscard]] virtual const task_network::TaskNetwork& network() const = 0;
  [[nodiscard]] virtual const task_network::Order& order() const = 0;
  [[nodiscard]] virtual const task_network::RunResult& result() const = 0;
  [[nodiscard]] virtual task_network::ListedNodes which_are_listed() const = 0;
  [[nodiscard]] draw::Gantt make_gantt() const override {
    return draw::gantt_of(network(), result(), *waits_, listed_, comparison_);
  }

  /// After the run.
  void compare(Duration sequential, Duration used) {
    comparison_.sequential = sequential;
    comparison_.critical_path = task_network::critical_path(network(), order(), result()).length;
    comparison_.shortest =
        std::max(comparison_.critical_path, task_network::busiest_resource(network(), result()));
    waits_.emplace(network(), order(), result());
    comparison_.speculation = task_network::speculation_of(network(), result(), *waits_);
    if (network().size() > 0) comparison_.engine_per_node = Microseconds(used) / network().size();
    overview_.name = network().name;
    overview_.makespan = result().makespan;
    listed_ = task_network::listed_nodes(network(), result(), which_are_listed());
    overview_.actions =
        static_cast<std::size_t>(std::ranges::count_if(listed_, [this](task_network::NodeId node) {
          const auto status = result().nodes[task_network::index(node)].status;
          return status != task_network::NodeStatus::Skipped &&
                 status != task_network::NodeStatus::NotReached;
        }));
  }

 private:
  [[nodiscard]] RunRow row(task_network::NodeId node) const {
    const task_network::NodeResult& own = result().nodes[task_network::index(node)];
    RunRow row{network().label(node),
               own.attempts > 0,
               own.started.time_since_epoch(),
               own.ended.time_since_epoch(),
               own.status,
               {},
               {}};
    if (const auto waits = waits_->of(node); !waits.empty()) {
      const task_network::NodeId other = waits.back().node;
      row.waited_for = to_string(
          waits.back(), task_network::index(other) == task_network::kNone ? "" : network().label(other));
    }
    return row;
  }

  // After the run.
  task_network::RunSummary comparison_;
  std::vector<task_network::NodeId> listed_;
  std::optional<task_network::WaitFinder> waits_;
};

class ConcurrentMissionRun final : public NetworkRun {
 public:
  Result<void> prepare(SharedProgram program, const RunRequest& request, const Concurrent& how) {
    convert::RunOptions options;
    auto runners = runners_for(request);
    auto start = open_journal(program->mission(), request, runners, options.journal);
    if (!start) return start.error();
    auto observe_units = follow_units(program->mission(), request, *start, options.journal.get());
    if (!observe_units) return observe_units.error();
    options.observe_units = std::move(*observe_units);
    runners.vary_durations(start->seed);
    auto inputs = inputs_by_port(*program, start->inputs);
    if (!inputs) return inputs.error();
    auto facts = parse_facts(start->facts, program->mission());
    if (!facts) return facts.error();
    options.facts = std::move(*facts);
    options.resources = start->resources;
    options.world_data = request.world_data;
    options.clock = clock_kind(request.clock);
    options.strict = how.strict;
    options.workers = how.workers.value_or(0);
    options.world_copies = how.world_copies.value_or(0);
    options.ahead = how.ahead.value_or(0);
    options.least_likelihood = how.least_likelihood;
    options.warn = request.note;
    options.observe = request.on_event;
    auto run = convert::Run::create(std::move(program), runners, std::move(*inputs), std::move(options));
    if (!run) return run.error();
    run_ = std::move(*run);
    return {};
  }

  void execute(RunControl* control, const std::stop_token& stop) {
    const ProcessorTime time;
    const mission::MissionResult* ended = nullptr;
    {
      const std::stop_callback end(stop, [this] { run_->stop(); });
      const RunControl::Attachment steering(
          control, {.set_paused = [this](bool paused) { paused ? run_->pause() : run_->resume(); }});
      ended = &run_->run();
    }
    compare(time_of_all(result()), time.used());
    overview_.outcome = ended->outcome_name;
    overview_.succeeded = ended->outcome >= 0;
    if (!ended->error.empty()) overview_.error = Error{ErrorCode::HookFailed, ended->error, {}, {}, {}};
    const auto& ports = *run_->plan().program().node(0).output_ports;
    for (std::size_t i = 0; i < ports.size(); ++i)
      overview_.outputs.append(ports[i].name, ended->outputs[i]);
  }

  [[nodiscard]] std::vector<std::string> why_in_sequence() const override {
    return convert::why_in_sequence(run_->plan(), order(), result());
  }

  /// That of the network, with what the mission adds.
  [[nodiscard]] Value to_value() override {
    Value document = NetworkRun::to_value();
    type::ValueMap& map = document.as_map();
    map.set("outcome", overview_.outcome);
    map.erase("error");
    if (overview_.error) map.set("error", overview_.error->message);
    map.set("outputs", overview_.outputs);
    map.set("globals", run_->globals().snapshot());
    Value::List causes;
    for (std::string& cause : why_in_sequence())
      causes.emplace_back(std::move(cause));
    map.set("in_sequence", std::move(causes));
    return document;
  }

 private:
  [[nodiscard]] const task_network::TaskNetwork& network() const override { return run_->plan().network(); }
  [[nodiscard]] const task_network::Order& order() const override { return run_->order(); }
  [[nodiscard]] const task_network::RunResult& result() const override { return run_->network_result(); }
  [[nodiscard]] task_network::ListedNodes which_are_listed() const override {
    return task_network::ListedNodes::Begun;
  }

  std::unique_ptr<convert::Run> run_;
};

/// Reports what begins and ends, and hands everything on.
class ObservedEnvironment final : public task_network::Environment {
 public:
  ObservedEnvironment(const task_network::FlatNetwork& flat, task_network::Environment& inner,
                      mission::StateObserver observe)
      : flat_(flat), inner_(inner), observe_(std::move(observe)) {}

  void start(task_network::NodeContext& context, task_network::Completions& completions) override {
    running_.insert_or_assign({task_network::index(context.node()), context.attempt()},
                              expected(context.node()));
    report(mission::StateEvent::Kind::Began, context.node(), {}, {});
    inner_.start(context, completions);
  }
  task_network::ReportPtr refuse(task_network::NodeContext& context, std::string why) override {
    report(mission::StateEvent::Kind::Began, context.node(), {}, {});
    report(mission::StateEvent::Kind::Ended, context.node(), name_of(task_network::kAborted), why);
    return inner_.refuse(context, std::move(why));
  }
  void cancel(task_network::NodeId node, std::uint32_t attempt,
              task_network::Completions& completions) override {
    running_.insert_or_assign({task_network::index(node), attempt}, task_network::kPreempted);
    inner_.cancel(node, attempt, completions);
  }
  void ended(task_network::NodeId node, std::uint32_t attempt) override {
    const auto found = running_.find({task_network::index(node), attempt});
    if (found != running_.end()) {
      report(mission::StateEvent::Kind::Ended, node, name_of(found->second), {});
      running_.erase(found);
    }
    inner_.ended(node, attempt);
  }
  [[nodiscard]] Duration patience() const override { return inner_.patience(); }

 private:
  void report(mission::StateEvent::Kind kind, task_network::NodeId node, std::string_view outcome,
              std::string_view error) const {
    observe_({kind, flat_.network.name_of(node), flat_.network[node].iteration, outcome, error});
  }
  [[nodiscard]] task_network::OutcomeId expected(task_network::NodeId node) const {
    return task_network::index(node) < flat_.trials.size() ? flat_.trials[task_network::index(node)].outcome
                                                           : task_network::kSuccess;
  }
  [[nodiscard]] std::string_view name_of(task_network::OutcomeId outcome) const {
    return flat_.network.outcomes.name(static_cast<std::uint32_t>(outcome));
  }

  const task_network::FlatNetwork& flat_;
  task_network::Environment& inner_;
  const mission::StateObserver observe_;
  /// Runs by node and attempt, and how they will end.
  std::map<std::pair<std::uint32_t, std::uint32_t>, task_network::OutcomeId> running_;
};

/// A network from a file, whose nodes are simulated.
class FlatNetworkRun final : public NetworkRun {
 public:
  explicit FlatNetworkRun(std::shared_ptr<const task_network::FlatNetwork> flat) : flat_(std::move(flat)) {}

  Result<void> prepare(const RunRequest& request) {
    if (!request.resources.empty()) {
      auto own = std::make_shared<task_network::FlatNetwork>(*flat_);
      for (const auto& [name, count] : request.resources) {
        const auto id = own->network.resources.find(name);
        if (!id) return fail(ErrorCode::NotFound, "no node uses a resource " + quote(name));
        own->network.resources[*id].count = count;
      }
      flat_ = std::move(own);
    }
    order_ = task_network::derive_order(network(), request.order);
    return {};
  }

  /// Also runs it sequentially in virtual time, for the comparison.
  void execute(const RunRequest& request, const std::stop_token& stop) {
    const auto* const concurrent = std::get_if<Concurrent>(&request.mode);
    const ProcessorTime time;
    task_network::SimulatedEnvironment simulated(network(), flat_->trials, request.seed.value_or(0));
    ObservedEnvironment observed(*flat_, simulated, request.on_event);
    task_network::Environment& environment =
        request.on_event ? static_cast<task_network::Environment&>(observed) : simulated;
    const auto clock = clock_kind(request.clock);
    result_ = concurrent == nullptr ? task_network::run_sequential(network(), environment, clock, stop)
                                    : run_concurrently(environment, *concurrent, clock, stop);
    const Duration used = time.used();
    const bool is_reference = concurrent == nullptr && request.clock == RunClock::Virtual && !result_.stopped;
    compare(is_reference ? result_.makespan : sequential_time(request, stop), used);
    overview_.outcome = task_network::outcome_of(result_);
    overview_.succeeded = result_.done();
    overview_.error = result_.error;
  }

 private:
  [[nodiscard]] const task_network::TaskNetwork& network() const override { return flat_->network; }
  [[nodiscard]] const task_network::Order& order() const override { return order_; }
  [[nodiscard]] const task_network::RunResult& result() const override { return result_; }
  [[nodiscard]] task_network::ListedNodes which_are_listed() const override {
    return task_network::ListedNodes::All;
  }

  [[nodiscard]] Duration sequential_time(const RunRequest& request, const std::stop_token& stop) const {
    task_network::SimulatedEnvironment environment(network(), flat_->trials, request.seed.value_or(0));
    const auto whole =
        task_network::run_sequential(network(), environment, task_network::ClockKind::Virtual, stop);
    return whole.stopped ? time_of_all(result_) : whole.makespan;
  }

  [[nodiscard]] task_network::RunResult run_concurrently(task_network::Environment& environment,
                                                         const Concurrent& how, task_network::ClockKind clock,
                                                         const std::stop_token& stop) const {
    task_network::ConcurrentEngineOptions options;
    options.clock = clock;
    options.strict = how.strict;
    options.workers = how.workers.value_or(0);
    options.world_copies = how.world_copies.value_or(0);
    options.ahead = how.ahead.value_or(0);
    options.least_likelihood = how.least_likelihood;
    options.priorities = task_network::choose_priorities(network(), order_, flat_->trials, options, stop);
    task_network::ConcurrentEngine engine(network(), order_, environment, options);
    const std::stop_callback end(stop, [&] { engine.stop(); });
    return engine.run();
  }

  std::shared_ptr<const task_network::FlatNetwork> flat_;
  task_network::Order order_;
  task_network::RunResult result_;
};

}  // namespace

RunResult run_concurrently(SharedProgram program, const RunRequest& request, const Concurrent& how,
                           const std::stop_token& stop) {
  auto run = std::make_unique<ConcurrentMissionRun>();
  if (auto prepared = run->prepare(std::move(program), request, how); !prepared) return prepared.error();
  run->execute(how.control, stop);
  return std::unique_ptr<FinishedRun>(std::move(run));
}

RunResult run_network(std::shared_ptr<const task_network::FlatNetwork> network, const RunRequest& request,
                      const std::stop_token& stop) {
  auto run = std::make_unique<FlatNetworkRun>(std::move(network));
  if (auto prepared = run->prepare(request); !prepared) return prepared.error();
  run->execute(request, stop);
  return std::unique_ptr<FinishedRun>(std::move(run));
}

}  // namespace segue::mission_run::detail
