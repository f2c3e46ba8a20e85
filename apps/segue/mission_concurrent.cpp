// SPDX-License-Identifier: Apache-2.0
#include "mission_concurrent.hpp"

#include <segue/base/text.hpp>
#include <segue/cdtn/critical_path.hpp>
#include <segue/convert/run.hpp>
#include <segue/mission/files.hpp>
#include <segue/mission/index.hpp>

#include <fmt/format.h>

#include <thread>

#include "mission_load.hpp"
#include "models.hpp"
#include "output.hpp"
#include "run_times.hpp"
#include "stop_signal.hpp"

namespace segue::cli {

namespace {

using Inputs = std::vector<type::Value>;

Result<void> set_input(const mission::Program& program, const std::string& text, Inputs& inputs) {
  auto given = parse_input(text);
  if (!given) return given.error();
  auto& [name, value] = *given;
  const auto& ports = *program.node(0).input_ports;
  const auto port = mission::position(ports, name);
  if (!port) return fail(ErrorCode::NotFound, "the mission has no input " + quote(name));
  if (!mission::accepts(ports[*port].type, value)) {
    return fail(ErrorCode::TypeMismatch, "the input " + quote(name) + " is of type " + ports[*port].type +
                                             ", not " + type::describe(value));
  }
  inputs[*port] = std::move(value);
  return {};
}

Result<std::unique_ptr<convert::Run>> prepare(mission::Mission loaded, const MissionOptions& options,
                                              const NetworkOptions& network) {
  auto program = mission::Program::compile(std::move(loaded));
  if (!program) return program.error();
  auto inputs = inputs_of(**program, options);
  if (!inputs) return inputs.error();
  convert::RunOptions settings;
  auto facts = given_facts(options.facts);
  if (!facts) return facts.error();
  settings.facts = std::move(*facts);
  settings.clock = options.clock == "virtual" ? cdtn::ClockKind::Virtual : cdtn::ClockKind::Real;
  settings.strict = network.strict;
  settings.workers = network.workers;
  settings.warn = [](const std::string& text) { print_note(text); };
  return convert::Run::create(*program, runners_of(options), std::move(*inputs), std::move(settings));
}

/// One after the other: as long as all that counted took together.
Duration time_of_all(const cdtn::RunResult& result) {
  Duration sum{};
  for (const cdtn::NodeResult& node : result.nodes) {
    if (node.status == cdtn::NodeStatus::Done) sum += node.ended - node.started;
  }
  return sum;
}

/// One run and what is shown of it.
class ConcurrentRun {
 public:
  ConcurrentRun(convert::Run& run, const Context& context) : run_(run), context_(context) {}

  /// Blocks until the mission has ended, or is stopped.
  void execute(StopSignal& stop) {
    std::thread watch([&] {
      stop.wait(std::nullopt);
      run_.stop();
    });
    const double before = thread_seconds();
    result_ = run_.run();
    const double used = thread_seconds() - before;
    stop.request("the mission has ended");
    watch.join();
    order_ = cdtn::derive_order(network());
    summary_.sequential = time_of_all(nodes());
    summary_.critical_path = cdtn::critical_path(network(), order_, nodes()).length;
    if (network().size() > 0) summary_.engine_us_per_node = used * 1e6 / network().size();
  }

  void show() const {
    if (context_.json()) return print_json(document());
    show_run(network(), order_, nodes(), summary_, context_);
    print_line(fmt::format("{}: {}", printable(network().name), printable(result_.outcome_name)));
    for (const auto& [port, value] : outputs())
      print_line(fmt::format("{}: {}", printable(port), one_line(value)));
    if (!result_.error.empty()) print_note(printable(result_.error));
  }

  [[nodiscard]] draw::Gantt gantt() const { return draw::gantt_of(network(), order_, nodes(), summary_); }
  [[nodiscard]] mission::Outcome outcome() const { return result_.outcome; }

 private:
  [[nodiscard]] const cdtn::TaskNetwork& network() const { return run_.plan().network(); }
  [[nodiscard]] const cdtn::RunResult& nodes() const { return run_.network_result(); }

  [[nodiscard]] type::ValueMap outputs() const {
    type::ValueMap map;
    const auto& ports = *run_.plan().program().node(0).output_ports;
    for (std::size_t i = 0; i < ports.size() && result_.outcome >= 0; ++i)
      map.append(ports[i].name, result_.outputs[i]);
    return map;
  }

  /// That of the network, with what the mission adds.
  [[nodiscard]] type::Value document() const {
    type::Value document = cdtn::to_value(network(), order_, nodes(), summary_);
    type::ValueMap& map = document.as_map();
    map.set("outcome", result_.outcome_name);
    map.erase("error");
    if (!result_.error.empty()) map.set("error", result_.error);
    map.set("outputs", outputs());
    map.set("globals", run_.globals().snapshot());
    return document;
  }

  convert::Run& run_;
  const Context& context_;
  mission::MissionResult result_;
  cdtn::Order order_;
  cdtn::RunSummary summary_;
};

}  // namespace

Result<std::vector<type::Value>> inputs_of(const mission::Program& program, const MissionOptions& options) {
  Inputs inputs(program.node(0).input_ports->size());
  for (const std::string& input : options.inputs) {
    if (auto set = set_input(program, input, inputs); !set) return set.error();
  }
  return inputs;
}

int run_mission_concurrently(const MissionOptions& options, const NetworkOptions& network,
                             const Context& context) {
  if (!options.start_at.empty() || !options.journal.empty()) {
    return failed(context,
                  fail(ErrorCode::Unsupported, "--start-at and --journal are for runs as they are written"));
  }
  if (const auto fits = check(options.files); !fits) return failed(context, fits.error());
  Diagnostics diagnostics;
  auto loaded = load_mission(options.file, options.libraries, diagnostics);
  if (!loaded) return report_failure(context, diagnostics);
  print_diagnostics(diagnostics);
  StopSignal stop;  // until what came of the run is shown
  auto prepared = prepare(std::move(*loaded), options, network);
  if (!prepared) return failed(context, prepared.error());
  ConcurrentRun run(**prepared, context);
  run.execute(stop);
  if (options.show) run.show();
  if (options.files.any()) {
    if (const auto written = write(options.files, run.gantt()); !written)
      return failed(Context{}, written.error());
  }
  return run.outcome() < 0 ? kFailed : kDone;
}

}  // namespace segue::cli
