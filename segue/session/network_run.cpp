// SPDX-License-Identifier: Apache-2.0
//
// Runs with the engine for task networks: of missions concurrently, and of networks from files in either
// mode.
#include <segue/base/text.hpp>
#include <segue/cdtn/concurrent_engine.hpp>
#include <segue/cdtn/critical_path.hpp>
#include <segue/cdtn/priority.hpp>
#include <segue/cdtn/sequential.hpp>
#include <segue/convert/run.hpp>
#include <segue/session/implementation.hpp>

namespace segue::session::detail {

namespace {

using type::Value;

/// How long all that counted took together.
Duration time_of_all(const cdtn::RunResult& result) {
  Duration sum{};
  for (const cdtn::NodeResult& node : result.nodes) {
    if (node.status == cdtn::NodeStatus::Done) sum += node.ended - node.started;
  }
  return sum;
}

/// What both kinds have: a network, its order, and what became of each node.
class NetworkRun : public FinishedRun {
 public:
  [[nodiscard]] bool as_written() const override { return false; }

  [[nodiscard]] std::vector<RunRow> rows(std::size_t most) const override {
    std::vector<RunRow> rows;
    const cdtn::WaitFinder finder(network(), order(), result());
    for (std::uint32_t i = 0; i < result().nodes.size() && rows.size() < most; ++i)
      rows.push_back(row(finder, cdtn::NodeId{i}));
    return rows;
  }

  [[nodiscard]] const cdtn::RunSummary& comparison() override { return comparison_; }
  [[nodiscard]] Value to_value() override {
    return cdtn::to_value(network(), order(), result(), comparison_);
  }

 protected:
  [[nodiscard]] virtual const cdtn::TaskNetwork& network() const = 0;
  [[nodiscard]] virtual const cdtn::Order& order() const = 0;
  [[nodiscard]] virtual const cdtn::RunResult& result() const = 0;
  [[nodiscard]] draw::Gantt make_gantt() const override {
    return draw::gantt_of(network(), order(), result(), comparison_);
  }

  /// After the run.
  void compare(Duration sequential, double used_us) {
    comparison_.sequential = sequential;
    comparison_.critical_path = cdtn::critical_path(network(), order(), result()).length;
    comparison_.engine_us_per_node = network().size() == 0 ? 0 : used_us / network().size();
    overview_.name = network().name;
    overview_.makespan = result().makespan;
    overview_.actions = result().nodes.size();
  }

 private:
  [[nodiscard]] RunRow row(const cdtn::WaitFinder& finder, cdtn::NodeId node) const {
    const cdtn::NodeResult& own = result().nodes[cdtn::index(node)];
    RunRow row{network().label(node),
               own.attempts > 0,
               own.started.time_since_epoch(),
               own.ended.time_since_epoch(),
               own.status,
               {},
               {}};
    if (const auto waits = finder.of(node); !waits.empty()) {
      const cdtn::NodeId other = waits.back().node;
      row.waited_for =
          to_string(waits.back(), cdtn::index(other) == cdtn::kNone ? "" : network().label(other));
    }
    return row;
  }

  cdtn::RunSummary comparison_;
};

class ConcurrentMissionRun final : public NetworkRun {
 public:
  Result<void> prepare(SharedProgram program, const RunRequest& request) {
    auto inputs = inputs_by_port(*program, request.inputs);
    if (!inputs) return inputs.error();
    auto facts = parse_facts(request.facts);
    if (!facts) return facts.error();
    convert::RunOptions options;
    options.facts = std::move(*facts);
    options.clock = request.clock;
    options.strict = request.strict;
    options.workers = request.workers;
    options.warn = request.note;
    options.observe = request.on_action;
    auto run = convert::Run::create(std::move(program), runners_for(request), std::move(*inputs),
                                    std::move(options));
    if (!run) return run.error();
    run_ = std::move(*run);
    return {};
  }

  void execute(std::stop_token stop) {
    const ProcessorTime time;
    const mission::MissionResult* ended = nullptr;
    {
      const std::stop_callback end(std::move(stop), [this] { run_->stop(); });
      ended = &run_->run();
    }
    compare(time_of_all(result()), time.microseconds());
    overview_.outcome = ended->outcome_name;
    overview_.succeeded = ended->outcome >= 0;
    if (!ended->error.empty()) overview_.error = Error{ErrorCode::HookFailed, ended->error, {}, {}, {}};
    const auto& ports = *run_->plan().program().node(0).output_ports;
    for (std::size_t i = 0; i < ports.size(); ++i)
      overview_.outputs.append(ports[i].name, ended->outputs[i]);
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
    return document;
  }

 private:
  [[nodiscard]] const cdtn::TaskNetwork& network() const override { return run_->plan().network(); }
  [[nodiscard]] const cdtn::Order& order() const override { return run_->order(); }
  [[nodiscard]] const cdtn::RunResult& result() const override { return run_->network_result(); }

  std::unique_ptr<convert::Run> run_;
};

/// A network from a file, whose nodes are simulated.
class FlatNetworkRun final : public NetworkRun {
 public:
  explicit FlatNetworkRun(std::shared_ptr<const cdtn::FlatNetwork> flat) : flat_(std::move(flat)) {}

  Result<void> prepare(const NetworkRequest& request) {
    if (!request.resources.empty()) {
      auto own = std::make_shared<cdtn::FlatNetwork>(*flat_);
      for (const auto& [name, count] : request.resources) {
        const auto id = own->network.resources.find(name);
        if (!id) return fail(ErrorCode::NotFound, "no node uses a resource " + quote(name));
        own->network.resources[*id].count = count;
      }
      flat_ = std::move(own);
    }
    order_ = cdtn::derive_order(network(), request.order);
    return {};
  }

  /// Also runs it sequentially in virtual time, for the comparison.
  void execute(const RunRequest& request, const std::stop_token& stop) {
    const bool sequential = request.mode == RunMode::Sequential;
    const ProcessorTime time;
    result_ = sequential ? run_sequentially(request.clock, request, stop) : run_concurrently(request, stop);
    const double used = time.microseconds();
    const bool is_reference = sequential && request.clock == cdtn::ClockKind::Virtual && !result_.stopped;
    compare(is_reference ? result_.makespan : sequential_time(request, stop), used);
    overview_.outcome = cdtn::outcome_of(result_);
    overview_.succeeded = result_.done();
    overview_.error = result_.error;
  }

 private:
  [[nodiscard]] const cdtn::TaskNetwork& network() const override { return flat_->network; }
  [[nodiscard]] const cdtn::Order& order() const override { return order_; }
  [[nodiscard]] const cdtn::RunResult& result() const override { return result_; }

  [[nodiscard]] Duration sequential_time(const RunRequest& request, const std::stop_token& stop) const {
    const auto whole = run_sequentially(cdtn::ClockKind::Virtual, request, stop);
    return whole.stopped ? time_of_all(result_) : whole.makespan;
  }

  [[nodiscard]] cdtn::RunResult run_sequentially(cdtn::ClockKind clock, const RunRequest& request,
                                                 const std::stop_token& stop) const {
    cdtn::SimulatedEnvironment environment(network(), flat_->trials, request.network.seed);
    return cdtn::run_sequential(network(), environment, clock, stop);
  }

  [[nodiscard]] cdtn::RunResult run_concurrently(const RunRequest& request,
                                                 const std::stop_token& stop) const {
    cdtn::ConcurrentEngineOptions options;
    options.clock = request.clock;
    options.strict = request.strict;
    options.workers = request.workers;
    options.world_copies = request.network.world_copies;
    options.priorities = cdtn::choose_priorities(network(), order_, flat_->trials, options, stop);
    cdtn::SimulatedEnvironment environment(network(), flat_->trials, request.network.seed);
    cdtn::ConcurrentEngine engine(network(), order_, environment, options);
    const std::stop_callback end(stop, [&] { engine.stop(); });
    return engine.run();
  }

  std::shared_ptr<const cdtn::FlatNetwork> flat_;
  cdtn::Order order_;
  cdtn::RunResult result_;
};

}  // namespace

RunResult run_concurrently(SharedProgram program, const RunRequest& request, std::stop_token stop) {
  auto run = std::make_unique<ConcurrentMissionRun>();
  if (auto prepared = run->prepare(std::move(program), request); !prepared) return prepared.error();
  run->execute(std::move(stop));
  return std::unique_ptr<FinishedRun>(std::move(run));
}

RunResult run_network(std::shared_ptr<const cdtn::FlatNetwork> network, const RunRequest& request,
                      std::stop_token stop) {
  auto run = std::make_unique<FlatNetworkRun>(std::move(network));
  if (auto prepared = run->prepare(request.network); !prepared) return prepared.error();
  run->execute(request, stop);
  return std::unique_ptr<FinishedRun>(std::move(run));
}

}  // namespace segue::session::detail
