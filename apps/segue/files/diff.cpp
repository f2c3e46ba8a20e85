// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/journal/journal_reader.hpp>
#include <segue/model/files.hpp>
#include <segue/runtime/runtime_report.hpp>
#include <segue/solve/estimate.hpp>
#include <segue/solve/solve.hpp>

#include <fmt/core.h>

#include <memory>
#include <optional>
#include <vector>

#include <segue/draw/transition_picture.hpp>
#include "../journal_file.hpp"
#include "../models.hpp"
#include "../output.hpp"
#include "../report_text.hpp"

namespace segue::cli {

namespace {

struct DiffOptions {
  std::string current;
  std::string target;
  std::string order = "seamless";
  bool force = false;
  bool dot = false;
  bool estimate = false;
  std::string journal;
  bool svg = false;
  std::string output;
  ModelSources sources;
};

/// Empty if no estimate is wanted.
Result<std::optional<solve::Estimate>> estimate_of(const DiffOptions& options, const std::string& robot,
                                                   const model::Network& current,
                                                   const model::Transition& transition) {
  if (!options.estimate) return std::optional<solve::Estimate>();
  const auto path = find_journal(options.journal, robot);
  if (!path) return path.error();
  auto reader = journal::JournalReader::open(*path);
  if (!reader) return reader.error();
  const auto times = reader->times_near(options.target);
  if (!times) return times.error();
  return std::optional(solve::estimate(current, transition, *times));
}

int show_transition(const model::Transition& transition, const std::optional<solve::Estimate>& expected,
                    const DiffOptions& options, const Context& context) {
  const auto durations = expected ? expected->typical : std::vector<Duration>();
  if (options.dot) return write_or_print(context, "", draw::to_dot(transition, durations));
  if (options.svg) return write_or_print(context, "", draw::to_svg(transition, durations));
  type::Value value = model::to_value(transition);
  if (expected) value.as_map().set("estimate_s", runtime::to_value(*expected));
  if (context.json())
    print_json(value);
  else
    print(describe_transition(value));
  return kDone;
}

int diff(const DiffOptions& options, const Context& context) {
  Diagnostics diagnostics;
  const auto catalog = load_catalog(options.sources, diagnostics);
  const auto current = load_valid_network(options.current, catalog, diagnostics);
  const auto target = load_valid_network(options.target, catalog, diagnostics);
  if (diagnostics.has_errors() || !current || !target) return report_failure(context, diagnostics);
  print_diagnostics(diagnostics);
  solve::Options asked;
  asked.order = options.order == "paper" ? model::Order::Paper : model::Order::Seamless;
  asked.force = options.force;
  const auto transition = solve::diff(*current, *target, catalog, asked);
  if (!transition) return failed(context, transition.error());
  if (!options.output.empty()) {
    const auto written = write_file(options.output, model::write_transition(*transition));
    if (!written) return failed(context, written.error());
  }
  const auto expected = estimate_of(options, context.robot, *current, *transition);
  if (!expected) return failed(context, expected.error());
  return show_transition(*transition, *expected, options, context);
}

}  // namespace

void add_diff(Verb& app, Context& context) {
  const auto options = std::make_shared<DiffOptions>();
  Verb& verb =
      add_verb(app, context, "diff", "compute the transition from one network to another",
               "  segue diff controllers/explore.yaml controllers/manual.yaml\n"
               "  segue diff - controllers/explore.yaml      # from the empty network\n"
               "  segue diff go_to.yaml go_to.yaml+move_arm.yaml      # to both at once\n"
               "  segue diff --estimate --robot artemis controllers/explore.yaml controllers/manual.yaml\n"
               "  segue diff a.yaml b.yaml --svg > switch.svg",
               [options, &context] { return diff(*options, context); });
  verb.option("CURRENT", options->current,
              "a network or CND file; A+B: both at once; '-' is the empty network")
      .required();
  verb.option("TARGET", options->target, "likewise").required();
  add_order_option(verb, options->order);
  verb.flag("--force", options->force, "kill the processes to be removed instead of stopping their tasks");
  const Option dot = verb.flag("--dot", options->dot, "print the partial order as a graph for Graphviz");
  verb.flag("--svg", options->svg, "draw a timeline with the critical path").excludes(dot);
  verb.option("-o,--output FILE", options->output,
              "also write the transition to a file, for `segue predict`");
  const Option estimate =
      verb.flag("--estimate", options->estimate,
                "also predict the duration from a robot's journal: in total, of each phase, critical path");
  verb.option("--robot NAME", context.robot,
              "the robot with the journal; needed if more than one robot has one")
      .needs(estimate);
  add_journal_option(verb, options->journal).needs(estimate);
  add_model_options(verb, options->sources);
}

}  // namespace segue::cli
