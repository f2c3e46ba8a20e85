// SPDX-License-Identifier: Apache-2.0
#include <segue/model/files.hpp>
#include <segue/solve/solve.hpp>
#include <segue/type/yaml.hpp>

#include <memory>

#include "../models.hpp"
#include "../output.hpp"

namespace segue::cli {

namespace {

struct PredictOptions {
  std::string network;
  std::string transition;
  std::string output;
  ModelSources sources;
};

int show_network(const model::Network& network, const PredictOptions& options, const Context& context) {
  const std::string text = model::write_network(network);
  if (!options.output.empty() || !context.json()) return write_or_print(context, options.output, text);
  const auto value = type::parse_yaml(text);
  if (!value) return failed(context, value.error());
  print_json(*value);
  return kDone;
}

int predict(const PredictOptions& options, const Context& context) {
  Diagnostics diagnostics;
  const auto catalog = load_catalog(options.sources, diagnostics);
  const auto network = load_valid_network(options.network, catalog, diagnostics);
  const auto transition = model::load_transition(options.transition, diagnostics);
  if (diagnostics.has_errors() || !network || !transition) return report_failure(context, diagnostics);
  print_diagnostics(diagnostics);
  const auto result = solve::predict(*network, *transition, catalog);
  return result ? show_network(*result, options, context) : failed(context, result.error());
}

}  // namespace

void add_predict(Verb& app, Context& context) {
  const auto options = std::make_shared<PredictOptions>();
  Verb& verb =
      add_verb(app, context, "predict", "predict the network that results from a transition",
               "  segue diff -o t.yaml explore.yaml manual.yaml\n  segue predict explore.yaml t.yaml",
               [options, &context] { return predict(*options, context); });
  verb.option("NETWORK", options->network, "a network or CND file; '-' is the empty network").required();
  verb.option("TRANSITION", options->transition, "a transition file").required();
  verb.option("-o,--output FILE", options->output, "write the network to a file");
  add_model_options(verb, options->sources);
}

}  // namespace segue::cli
