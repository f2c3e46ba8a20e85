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
  if (!options.start_at.empty()) {
    return failed(context, fail(ErrorCode::Unsupported,
                                "--start-at begins in the middle, which only a sequential run can"));
  }
  if (!options.journal.empty()) {
    return failed(context, fail(ErrorCode::Unsupported, "--journal is for sequential runs"));
  }
  if (const auto fits = check(options.files); !fits) return failed(context, fits.error());
  Diagnostics diagnostics;
  auto loaded = load_mission(options.file, options.libraries, diagnostics);
  if (!loaded) return report_failure(context, diagnostics);
  print_diagnostics(diagnostics);
  StopSignal stop;  // until what came of the run is shown
  auto run = prepare(std::move(*loaded), options, network);
  if (!run) return failed(context, run.error());
  std::thread watch([&] {
    stop.wait(std::nullopt);
    (*run)->stop();
  });
  const double before = thread_seconds();
  const mission::MissionResult& result = (*run)->run();
  const double used = thread_seconds() - before;
  stop.request("the mission has ended");
  watch.join();

  const cdtn::Network& plan = (*run)->plan().network();
  const cdtn::RunResult& nodes = (*run)->network_result();
  const cdtn::Order order = cdtn::derive_order(plan);
  cdtn::RunSummary summary;
  summary.sequential = time_of_all(nodes);
  summary.critical_path = cdtn::critical_path(plan, order, nodes).length;
  if (plan.size() > 0) summary.engine_us_per_node = used * 1e6 / plan.size();
  if (options.show) {
    show_run(plan, order, nodes, summary, context);
    if (!context.json()) {
      const auto& program = (*run)->plan().program();
      print_line(fmt::format("{}: {}", printable(plan.name), printable(result.outcome_name)));
      const auto& ports = *program.node(0).output_ports;
      for (std::size_t i = 0; i < ports.size() && result.outcome >= 0; ++i)
        print_line(fmt::format("{}: {}", printable(ports[i].name), one_line(result.outputs[i])));
      if (!result.error.empty()) print_note(printable(result.error));
    }
  }
  if (options.files.any()) {
    const auto written = write(options.files, cdtn::gantt_of(plan, order, nodes, summary));
    if (!written) return failed(Context{}, written.error());
  }
  return result.outcome < 0 ? kFailed : kDone;
}

}  // namespace segue::cli
