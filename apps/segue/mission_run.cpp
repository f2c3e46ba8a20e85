// SPDX-License-Identifier: Apache-2.0
#include "mission_run.hpp"

#include <segue/base/virtual_clock.hpp>
#include <segue/mission/engine.hpp>
#include <segue/mission/script_runner.hpp>
#include <segue/type/yaml.hpp>

#include <fmt/format.h>

#include <thread>

#include <segue/draw/mission_gantt.hpp>
#include "mission_load.hpp"
#include "models.hpp"
#include "output.hpp"
#include "run_times.hpp"
#include "stop_signal.hpp"

namespace segue::cli {

namespace {

using type::Value;
using type::ValueMap;

/// More are no help to a reader; --format json has all.
constexpr std::size_t kMostRows = 1000;

/// One run from its options to what is shown of it.
class MissionRun {
 public:
  MissionRun(const MissionOptions& options, const Context& context) : options_(options), context_(context) {}

  int run() {
    if (const auto fits = check(options_.files); !fits) return failed(context_, fits.error());
    Diagnostics diagnostics;
    auto loaded = load_mission(options_.file, options_.libraries, diagnostics);
    if (!loaded) return report_failure(context_, diagnostics);
    print_diagnostics(diagnostics);
    if (auto prepared = prepare(std::move(*loaded)); !prepared) return failed(context_, prepared.error());
    begin_ = clock().now();
    const double before = thread_seconds();
    execute();
    const double used = thread_seconds() - before;
    engine_us_ = engine_->executions() == 0 ? 0 : used * 1e6 / static_cast<double>(engine_->executions());
    makespan_ = clock().now() - begin_;
    if (context_.json() || options_.files.any()) make_gantt();
    if (options_.show) context_.json() ? show_json() : show_text();
    // Standard output has had its document.
    if (const auto written = write(options_.files, gantt_); !written)
      return failed(Context{}, written.error());
    return engine_->result().outcome < 0 ? kFailed : kDone;
  }

 private:
  Clock& clock() {
    if (options_.clock == "virtual") return virtual_clock_;
    return RealClock::instance();
  }

  Result<void> prepare(mission::Mission loaded) {
    auto program = mission::Program::compile(std::move(loaded));
    if (!program) return program.error();
    mission::EngineOptions settings;
    settings.clock = &clock();
    settings.warn = [](const std::string& text) { print_note(text); };
    auto start = beginning((*program)->mission(), settings.journal);
    if (!start) return start.error();
    auto facts = given_facts(start->facts);
    if (!facts) return facts.error();
    settings.facts = std::move(*facts);
    auto engine = mission::Engine::create(*program, runners_of(options_), std::move(settings));
    if (!engine) return engine.error();
    engine_ = std::move(*engine);
    for (const auto& [name, value] : start->inputs) {
      if (auto set = engine_->set_input(name, value); !set) return set;
    }
    return start->start_at.empty() ? Result<void>{} : engine_->start_at(start->start_at);
  }

  /// What the options say, or the journal of the run that goes on.
  Result<mission::RunJournal::Start> beginning(const mission::Mission& mission,
                                               std::shared_ptr<mission::RunJournal>& journal) const {
    const auto warn = [](const std::string& text) { print_note(text); };
    mission::RunJournal::Start start{{}, options_.facts, options_.start_at};
    for (const std::string& input : options_.inputs) {
      auto given = parse_input(input);
      if (!given) return given.error();
      start.inputs.erase(given->first);
      start.inputs.append(given->first, std::move(given->second));
    }
    if (options_.journal.empty()) return start;
    if (!options_.resume) {
      auto made = mission::RunJournal::create(options_.journal, mission, start, warn);
      if (!made) return made.error();
      journal = std::move(*made);
      return start;
    }
    if (!start.inputs.empty() || !start.facts.empty() || !start.start_at.empty()) {
      return fail(ErrorCode::InvalidArgument,
                  "a run that goes on has the inputs, facts and start that it began with");
    }
    auto found = mission::RunJournal::resume(options_.journal, mission, under_way(), warn);
    if (!found) return found.error();
    journal = std::move(*found);
    print_note(fmt::format("the run goes on: {} {} had ended", journal->size(),
                           journal->size() == 1 ? "action" : "actions"));
    return journal->start();
  }

  [[nodiscard]] mission::RunJournal::UnderWay under_way() const {
    using UnderWay = mission::RunJournal::UnderWay;
    if (options_.under_way == "again") return UnderWay::Again;
    if (options_.under_way == "skip") return UnderWay::Skip;
    return options_.under_way == "abort" ? UnderWay::Abort : UnderWay::Refuse;
  }

  /// The engine in this thread; another waits for a signal meanwhile.
  void execute() {
    std::thread watch([&] {
      stop_.wait(std::nullopt);
      engine_->stop();
    });
    engine_->run();
    stop_.request("the mission has ended");
    watch.join();
  }

  void make_gantt() {
    gantt_ = draw::gantt_of(engine_->program(), engine_->history(), engine_->result().outcome, begin_,
                            begin_ + makespan_);
    gantt_.summary.engine_us_per_node = engine_us_;
  }

  [[nodiscard]] double since_begin(TimePoint when) const { return seconds(when - begin_); }

  void show_text() {
    using Align = Table::Align;
    Table table({{"START", Align::Right},
                 {"DURATION", Align::Right},
                 {"STATE", Align::Left},
                 {"OUTCOME", Align::Left}});
    const auto& history = engine_->history();
    std::size_t actions = 0;
    for (std::uint32_t i = 0; i < history.items().size(); ++i) {
      const auto& item = history.items()[i];
      if (!draw::is_leaf(engine_->program(), item.state)) continue;
      if (++actions > kMostRows) continue;
      const std::string path = history.path(engine_->program(), i);
      table.add({format_seconds(since_begin(item.began)), format_seconds(seconds(item.end - item.began)),
                 printable(path.empty() ? name() : path), printable(outcome(item))});
    }
    print(table.text());
    if (actions > kMostRows) print_note(fmt::format("{} more actions are not shown", actions - kMostRows));
    const auto& result = engine_->result();
    print_line(fmt::format("{}: {} after {}, {} action{}", printable(name()), printable(result.outcome_name),
                           format_seconds(seconds(makespan_)), actions, actions == 1 ? "" : "s"));
    if (!result.error.empty()) print_note(printable(result.error));
    for (const auto& [port, value] : outputs())
      print_line(fmt::format("{}: {}", printable(port), one_line(value)));
  }

  [[nodiscard]] const std::string& name() const { return engine_->program().mission().name; }

  [[nodiscard]] std::string outcome(const mission::History::Item& item) const {
    return item.ended ? engine_->program().outcome_name(item.state, item.outcome) : "under way";
  }

  [[nodiscard]] ValueMap outputs() const {
    ValueMap map;
    const auto& ports = *engine_->program().node(0).output_ports;
    for (std::size_t i = 0; i < ports.size(); ++i)
      map.append(ports[i].name, engine_->result().outputs[i]);
    return map;
  }

  void show_json() {
    Value::List nodes;
    const auto& history = engine_->history();
    for (std::uint32_t i = 0; i < history.items().size(); ++i) {
      if (draw::is_leaf(engine_->program(), history.items()[i].state))
        nodes.push_back(node(i, gantt_.nodes[nodes.size()]));
    }
    const auto& result = engine_->result();
    ValueMap map;
    map.append("outcome", result.outcome_name);
    if (!result.error.empty()) map.append("error", result.error);
    map.append("makespan_s", seconds(makespan_));
    map.append("sequential_s", seconds(gantt_.summary.sequential));
    map.append("critical_path_s", seconds(gantt_.summary.critical_path));
    map.append("nodes", std::move(nodes));
    map.append("outputs", outputs());
    map.append("globals", engine_->globals().snapshot());
    Value::List world;
    for (const std::string& fact : engine_->world().facts())
      world.emplace_back(fact);
    map.append("world", std::move(world));
    map.append("engine_us_per_node", engine_us_);
    print_json(map);
  }

  [[nodiscard]] Value::List waited_for(const draw::Gantt::Node& shown) const {
    Value::List waits;
    for (const cdtn::Wait& wait : shown.waits)
      waits.push_back(cdtn::to_value(wait, gantt_.nodes[cdtn::index(wait.node)].name));
    return waits;
  }

  [[nodiscard]] Value node(std::uint32_t i, const draw::Gantt::Node& shown) const {
    const auto& history = engine_->history();
    const auto& item = history.items()[i];
    const mission::Program& program = engine_->program();
    const mission::Action& action = program.mission().actions[program.node(item.state).action];
    Value::List resources;
    for (const mission::ResourceUse& use : action.resources)
      resources.emplace_back(use.resource);
    const std::string path = history.path(program, i);
    Value node = Value::map({{"name", path.empty() ? name() : path},
                             {"iteration", static_cast<std::uint64_t>(item.iteration)},
                             {"start_s", since_begin(item.began)},
                             {"end_s", since_begin(item.end)},
                             {"status", std::string(cdtn::to_string(shown.status))},
                             {"outcome", outcome(item)},
                             {"pia", !action.pure},
                             {"resources", std::move(resources)},
                             {"waited_for", waited_for(shown)}});
    if (const auto error = history.error(i); !error.empty()) node.as_map().append("error", error);
    return node;
  }

  StopSignal stop_;  ///< until what came of the run is shown
  const MissionOptions& options_;
  const Context& context_;
  VirtualClock virtual_clock_;
  std::unique_ptr<mission::Engine> engine_;
  TimePoint begin_{};
  Duration makespan_{};
  draw::Gantt gantt_;
  double engine_us_ = 0;
};

}  // namespace

mission::Runners runners_of(const MissionOptions& options) {
  mission::Runners runners;
  mission::ScriptOptions scripts;
  scripts.python = options.python;
  runners.set_scripts(std::make_shared<mission::ScriptRunner>(std::move(scripts)));
  if (options.simulate) runners.simulate_all();
  return runners;
}

Result<std::pair<std::string, Value>> parse_input(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos)
    return fail(ErrorCode::InvalidArgument, "--input must be NAME=VALUE, got '" + text + "'");
  auto value = type::parse_yaml(text.substr(equals + 1));
  if (!value) return value.error();
  return std::pair(text.substr(0, equals), std::move(*value));
}

Result<std::vector<mission::Fact>> given_facts(const std::vector<std::string>& texts) {
  std::vector<mission::Fact> facts;
  for (const std::string& text : texts) {
    auto fact = mission::parse_initial_fact(text);
    if (!fact) return fact.error();
    facts.push_back(std::move(*fact));
  }
  return facts;
}

int run_mission(const MissionOptions& options, const Context& context) {
  return MissionRun(options, context).run();
}

}  // namespace segue::cli
