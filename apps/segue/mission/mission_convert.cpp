// SPDX-License-Identifier: Apache-2.0
#include "mission_convert.hpp"

#include <segue/convert/ahead_of_failures.hpp>
#include <segue/draw/diagram.hpp>
#include <segue/mission_run/loaded_mission.hpp>
#include <segue/type/json.hpp>

#include <algorithm>

#include "../models.hpp"
#include "../output.hpp"
#include "run_files.hpp"

namespace segue::cli {

namespace {

using draw::Diagram;

/// Names that others wrote, with nothing in them that a terminal or a line of text would take for its own.
void make_printable(Diagram& diagram) {
  const auto make = [](std::string& text) {
    text = printable(text);
    std::ranges::replace_if(
        text, [](char c) { return c == '\n' || c == '\t'; }, ' ');
  };
  make(diagram.name);
  make(diagram.waits_for);
  for (task_network::NamedActsAhead& each : diagram.ahead) {
    make(each.acts);
    for (std::string& name : each.fails)
      make(name);
  }
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

std::string diagram_text(Diagram diagram, const ConvertOptions& options, const Context& context) {
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
  const auto plan =
      mission_run::LoadedMission::load(options.mission.file, {.libraries = options.mission.libraries});
  if (!plan) return report_failure(context, plan.error());
  print_diagnostics(plan->warnings());
  auto inputs = parse_inputs(options.mission.inputs);
  if (!inputs) return failed(context, inputs.error());
  mission_run::ConvertRequest request;
  request.inputs = std::move(*inputs);
  request.facts = options.mission.facts;
  request.horizon = options.horizon;
  request.strict = options.strict;
  request.assume_expected = options.assume_expected;
  if (options.order == "goal") request.order = task_network::OrderRule::Goal;
  request.note = [](const std::string& text) { print_note(text); };
  auto diagram = plan->convert(request);
  if (!diagram) return failed(context, diagram.error());
  auto ahead = plan->ahead_of_failures(request);
  if (!ahead) return failed(context, ahead.error());
  diagram->ahead = std::move(ahead->pairs);
  diagram->senses_ahead = std::move(ahead->senses);
  diagram->ahead_complete = ahead->complete;
  const std::string text = diagram_text(std::move(*diagram), options, context);
  return write_or_print(context, options.output, text);
}

}  // namespace segue::cli
