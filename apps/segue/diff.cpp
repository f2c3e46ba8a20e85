// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/model/files.hpp>
#include <segue/solve/solve.hpp>

#include <fmt/format.h>

#include <map>
#include <memory>

#include "models.hpp"
#include "output.hpp"
#include "transition_text.hpp"

namespace segue::cli {

namespace {

struct Options {
  std::string current;
  std::string target;
  std::string order = "seamless";
  bool dot = false;
  std::string output;
  ModelSources sources;
};

/// The partial order as a graph for Graphviz.
std::string to_dot(const model::Transition& transition) {
  static const std::map<model::Phase, std::string_view> colours = {{model::Phase::Prepare, "lightblue"},
                                                                   {model::Phase::Commit, "orange"},
                                                                   {model::Phase::Retire, "lightgrey"}};
  const auto escaped = [](const std::string& text) {
    std::string result;
    for (const char c : text)
      result += c == '"' || c == '\\' ? std::string{'\\', c} : std::string(1, c);
    return result;
  };
  std::string text = "digraph transition {\n  node [shape=box, style=filled];\n";
  for (const model::Action& action : transition.actions) {
    text += fmt::format("  {} [label=\"{}\", fillcolor={}];\n", action.id, escaped(action.label()),
                        colours.at(action.phase));
    for (const int before : action.after)
      text += fmt::format("  {} -> {};\n", before, action.id);
  }
  return text + "}\n";
}

void show(const model::Transition& transition, bool dot, const Context& context) {
  if (dot) return print(to_dot(transition));
  if (context.json()) return print_json(model::to_value(transition));
  print(describe(transition));
}

int diff(const Options& options, const Context& context) {
  Diagnostics diagnostics;
  const auto catalog = load_catalog(options.sources, diagnostics);
  const auto current = load_valid_network(options.current, catalog, diagnostics);
  const auto target = load_valid_network(options.target, catalog, diagnostics);
  if (diagnostics.has_errors() || !current || !target) return report_failure(context, diagnostics);
  print_diagnostics(diagnostics);
  const auto order = options.order == "paper" ? model::Order::Paper : model::Order::Seamless;
  const auto transition = solve::diff(*current, *target, catalog, {order});
  if (!transition) return failed(context, transition.error());
  if (!options.output.empty()) {
    const auto written = write_file(options.output, model::write_transition(*transition));
    if (!written) return failed(context, written.error());
  }
  show(*transition, options.dot, context);
  return kDone;
}

}  // namespace

void add_diff(CLI::App& app, Context& context) {
  const auto options = std::make_shared<Options>();
  CLI::App* verb = add_verb(app, context, "diff", "the transition that turns one network into another",
                            "  segue diff controllers/explore.yaml controllers/manual.yaml\n"
                            "  segue diff - controllers/explore.yaml      # from the empty network",
                            [options, &context] { return diff(*options, context); });
  verb->add_option("CURRENT", options->current, "a network or CND file; '-' is the empty network")
      ->required()
      ->type_name("");
  verb->add_option("TARGET", options->target, "likewise")->required()->type_name("");
  add_order_option(*verb, options->order);
  verb->add_flag("--dot", options->dot, "the partial order as a graph for Graphviz");
  verb->add_option("-o,--output", options->output, "also write the transition to a file, for `segue apply`")
      ->type_name("FILE");
  add_model_options(*verb, options->sources);
}

}  // namespace segue::cli
