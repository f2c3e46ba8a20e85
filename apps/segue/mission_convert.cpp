// SPDX-License-Identifier: Apache-2.0
#include "mission_convert.hpp"

#include <segue/base/file.hpp>
#include <segue/cdtn/flat_file.hpp>
#include <segue/convert/run.hpp>
#include <segue/draw/diagram.hpp>
#include <segue/draw/plan_diagram.hpp>
#include <segue/type/json.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "mission_concurrent.hpp"
#include "mission_load.hpp"
#include "mission_network.hpp"
#include "models.hpp"
#include "output.hpp"

namespace segue::cli {

namespace {

using draw::Diagram;

std::optional<Diagram> of_network(const ConvertOptions& options, Diagnostics& diagnostics) {
  const auto flat = cdtn::load_flat_network(options.mission.file, diagnostics);
  if (!flat) return std::nullopt;
  const auto rule = options.order == "goal" ? cdtn::OrderRule::Goal : cdtn::OrderRule::Epoch;
  std::vector<cdtn::Dependency> further;
  const cdtn::Order order = cdtn::derive_order(flat->network, rule, &further);
  return draw::diagram_of(flat->network, order, further);
}

Result<Diagram> of_mission(mission::Mission loaded, const ConvertOptions& options) {
  auto program = mission::Program::compile(std::move(loaded));
  if (!program) return program.error();
  auto inputs = inputs_of(**program, options.mission);
  if (!inputs) return inputs.error();
  const auto facts = given_facts(options.mission.facts);
  if (!facts) return facts.error();
  auto plan = convert::MissionPlan::create(*program, std::move(*inputs), *facts);
  if (!plan) return plan.error();
  MissionOptions simulated = options.mission;
  simulated.simulate = true;
  const mission::Runners runners = runners_of(simulated);
  const auto failure =
      convert::plan_ahead(**plan, options.horizon, options.assume_expected ? &runners : nullptr);
  if (!failure) return failure.error();
  if (*failure) print_note(printable("as expected, the mission fails: " + (*failure)->message));
  return draw::diagram_of(**plan);
}

/// Names that others wrote, with nothing in them that a terminal or a line of text would take for its own.
void make_printable(Diagram& diagram) {
  const auto make = [](std::string& text) {
    text = printable(text);
    std::ranges::replace_if(
        text, [](char c) { return c == '\n' || c == '\t'; }, ' ');
  };
  make(diagram.name);
  make(diagram.waits_for);
  for (Diagram::Node& node : diagram.nodes) {
    make(node.name);
    make(node.note);
    for (Diagram::Dependency& dependency : node.before) {
      for (Diagram::Cause& cause : dependency.causes) {
        make(cause.subject);
        make(cause.detail);
      }
    }
  }
}

std::string written(Diagram diagram, const ConvertOptions& options, const Context& context) {
  if (options.dot) return to_dot(diagram);
  if (options.svg) return to_svg(diagram);
  if (context.json()) return type::to_json(to_value(diagram), 2) + "\n";
  make_printable(diagram);
  return to_text(diagram);
}

}  // namespace

int convert_plan(const ConvertOptions& options, const Context& context) {
  if (!options.output.empty()) {
    if (const auto fits = check_writable(options.output); !fits) return failed(context, fits.error());
  }
  Diagnostics diagnostics;
  std::optional<Diagram> diagram;
  if (is_task_network(options.mission.file)) {
    if (!options.mission.inputs.empty() || !options.mission.facts.empty()) {
      return failed(context, fail(ErrorCode::Unsupported,
                                  "--input and --fact are for missions, not for task networks"));
    }
    diagram = of_network(options, diagnostics);
    if (!diagram) return report_failure(context, diagnostics);
    print_diagnostics(diagnostics);
  } else {
    auto loaded = load_mission(options.mission.file, options.mission.libraries, diagnostics);
    if (!loaded) return report_failure(context, diagnostics);
    print_diagnostics(diagnostics);
    auto made = of_mission(std::move(*loaded), options);
    if (!made) return failed(context, made.error());
    diagram = std::move(*made);
  }
  diagram->strict = options.strict;
  const std::string text = written(std::move(*diagram), options, context);
  if (options.output.empty()) {
    print(text);
    return kDone;
  }
  const auto done = write_file(options.output, text);
  return done ? kDone : failed(context, done.error());
}

}  // namespace segue::cli
