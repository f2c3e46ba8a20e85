// SPDX-License-Identifier: Apache-2.0
#include <segue/base/virtual_clock.hpp>
#include <segue/draw/mission_gantt.hpp>
#include <segue/mission_engine/engine.hpp>
#include <segue/mission_run/implementation.hpp>
#include <segue/mission_run/run_control.hpp>

namespace segue::mission_run::detail {

namespace {

using mission::RunJournal;
using type::Value;
using type::ValueMap;

/// A mission as it is written, with the reference engine.
class SequentialRun final : public FinishedRun {
 public:
  explicit SequentialRun(RunClock clock)
      : clock_(clock == RunClock::Virtual ? static_cast<Clock&>(virtual_clock_) : RealClock::instance()) {}

  Result<void> prepare(SharedProgram program, const RunRequest& request,
                       const std::optional<Stepping>& stepping) {
    mission::EngineOptions options;
    options.clock = &clock_;
    options.warn = request.note;
    options.on_held = [this] {
      if (tell_held_) tell_held_();
    };
    options.observe = request.on_event;
    options.backward = stepping && stepping->steps_back;
    auto runners = runners_for(request);
    auto start = open_journal(program->mission(), request, runners, options.journal);
    if (!start) return start.error();
    auto observe_units = follow_units(program->mission(), request, *start, options.journal.get());
    if (!observe_units) return observe_units.error();
    options.observe_units = std::move(*observe_units);
    runners.vary_durations(start->seed);
    auto facts = parse_facts(start->facts, program->mission());
    if (!facts) return facts.error();
    options.facts = std::move(*facts);
    options.resources = start->resources;
    options.world_data = request.world_data;
    auto engine = mission::Engine::create(std::move(program), runners, std::move(options));
    if (!engine) return engine.error();
    engine_ = std::move(*engine);
    for (const auto& [name, value] : start->inputs) {
      if (auto set = engine_->set_input(name, value); !set) return set;
    }
    if (stepping) {
      if (auto set = engine_->set_breakpoints(stepping->breakpoints); !set) return set;
    }
    return start->start_at.empty() ? Result<void>{} : engine_->start_at(start->start_at);
  }

  void execute(const std::optional<Stepping>& stepping, const std::stop_token& stop) {
    begin_ = clock_.now();
    const ProcessorTime time;
    {
      const std::stop_callback end(stop, [this] { engine_->stop(); });
      run_engine(stepping);
    }
    if (engine_->executions() > 0)
      engine_time_ = Microseconds(time.used()) / static_cast<double>(engine_->executions());
    const mission::MissionResult& result = engine_->result();
    overview_.name = program().mission().name;
    overview_.outcome = result.outcome_name;
    overview_.succeeded = result.outcome >= 0;
    if (!result.error.empty()) overview_.error = Error{ErrorCode::HookFailed, result.error, {}, {}, {}};
    const auto& ports = *program().node(0).output_ports;
    for (std::size_t i = 0; i < ports.size(); ++i)
      overview_.outputs.append(ports[i].name, result.outputs[i]);
    overview_.makespan = clock_.now() - begin_;
    for (const mission::History::Item& item : items())
      overview_.actions += is_leaf(item.state) ? 1 : 0;
  }

  [[nodiscard]] bool as_written() const override { return true; }

  [[nodiscard]] std::vector<RunRow> rows(std::size_t most) const override {
    std::vector<RunRow> rows;
    for (std::uint32_t i = 0; i < items().size() && rows.size() < most; ++i) {
      const auto& item = items()[i];
      if (!is_leaf(item.state)) continue;
      rows.push_back({name_of(i),
                      true,
                      item.began - begin_,
                      item.end - begin_,
                      item.ended ? task_network::NodeStatus::Done : task_network::NodeStatus::NotReached,
                      item.ended ? program().outcome_name(item.state, item.outcome) : "",
                      {}});
    }
    return rows;
  }

  [[nodiscard]] const task_network::RunSummary& comparison() override { return gantt().summary; }

  [[nodiscard]] Value to_value() override {
    Value::List nodes;
    for (std::uint32_t i = 0; i < items().size(); ++i) {
      if (is_leaf(items()[i].state)) nodes.push_back(node(i, gantt().nodes[nodes.size()]));
    }
    ValueMap map;
    map.append("outcome", overview_.outcome);
    if (overview_.error) map.append("error", overview_.error->message);
    map.append("makespan_s", seconds(overview_.makespan));
    map.append("sequential_s", seconds(comparison().sequential));
    map.append("critical_path_s", seconds(comparison().critical_path));
    map.append("shortest_s", seconds(comparison().shortest));
    map.append("nodes", std::move(nodes));
    map.append("outputs", overview_.outputs);
    map.append("globals", engine_->globals().snapshot());
    Value::List world;
    for (const std::string& fact : engine_->world().facts())
      world.emplace_back(fact);
    map.append("world", std::move(world));
    ValueMap units;
    for (const auto& [resource, count] : engine_->units().counts())
      units.append(resource, static_cast<std::uint64_t>(count));
    map.append("units", std::move(units));
    map.append("engine_us_per_node", engine_time_.count());
    return map;
  }

 protected:
  [[nodiscard]] draw::Gantt make_gantt() const override {
    draw::Gantt gantt = draw::gantt_of(program(), engine_->history(), engine_->result().outcome, begin_,
                                       begin_ + overview_.makespan);
    gantt.summary.engine_per_node = engine_time_;
    return gantt;
  }

 private:
  void run_engine(const std::optional<Stepping>& stepping) {
    RunControl::Run steered{.engine = engine_.get()};
    if (stepping) {
      steered.back = stepping->steps_back;
      steered.breakpoints = stepping->breakpoints;
    }
    RunControl::Attachment steering(stepping ? &stepping->control.get() : nullptr, std::move(steered));
    tell_held_ = [&] {
      const auto paths = engine_->held_at();
      if (steering.held_at(paths) && stepping && stepping->on_held) stepping->on_held(paths);
    };
    while (engine_->run() == mission::Engine::Progress::Held) {
      tell_held_();
      engine_->wait_for_message();
    }
    tell_held_ = {};
  }

  [[nodiscard]] const mission::Program& program() const { return engine_->program(); }
  [[nodiscard]] const std::vector<mission::History::Item>& items() const {
    return engine_->history().items();
  }
  [[nodiscard]] bool is_leaf(mission::StateIndex state) const {
    return mission::is_leaf(program().node(state).kind);
  }
  [[nodiscard]] std::string name_of(std::uint32_t item) const {
    std::string path = engine_->history().path(program(), item);
    return path.empty() ? program().mission().name : path;
  }

  [[nodiscard]] Value node(std::uint32_t i, const draw::Gantt::Node& shown) {
    const mission::History& history = engine_->history();
    const auto& item = items()[i];
    const mission::Action& action = program().mission().actions[program().node(item.state).action];
    Value::List resources;
    for (const mission::ResourceUse& use : action.resources)
      resources.emplace_back(use.resource);
    Value::List waits;
    for (const task_network::Wait& wait : shown.waits) {
      const std::uint32_t other = task_network::index(wait.node);
      waits.push_back(task_network::to_value(
          wait, other == task_network::kNone ? std::string() : gantt().nodes[other].name));
    }
    Value node =
        Value::map({{"name", name_of(i)},
                    {"iteration", static_cast<std::uint64_t>(item.iteration)},
                    {"start_s", seconds(item.began - begin_)},
                    {"end_s", seconds(item.end - begin_)},
                    {"status", std::string(task_network::to_string(shown.status))},
                    {"outcome", item.ended ? program().outcome_name(item.state, item.outcome) : "under way"},
                    {"pia", action.action_class() == ActionClass::Irreversible},
                    {"resources", std::move(resources)},
                    {"waited_for", std::move(waits)}});
    if (const auto error = history.error(i); !error.empty()) node.as_map().append("error", error);
    return node;
  }

  VirtualClock virtual_clock_;
  Clock& clock_;
  std::unique_ptr<mission::Engine> engine_;
  std::function<void()> tell_held_;  ///< while it runs
  TimePoint begin_{};
  Microseconds engine_time_{};  ///< for each execution
};

}  // namespace

RunResult run_as_written(SharedProgram program, const RunRequest& request, const Sequential& how,
                         const std::stop_token& stop) {
  auto run = std::make_unique<SequentialRun>(request.clock);
  if (auto prepared = run->prepare(std::move(program), request, how.stepping); !prepared)
    return prepared.error();
  run->execute(how.stepping, stop);
  return std::unique_ptr<FinishedRun>(std::move(run));
}

}  // namespace segue::mission_run::detail
