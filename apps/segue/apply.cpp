// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/model/files.hpp>
#include <segue/solve/solve.hpp>
#include <segue/type/yaml.hpp>

#include <memory>

#include "models.hpp"
#include "output.hpp"

namespace segue::cli {

namespace {

struct Options {
  std::string network;
  std::string transition;
  std::string output;
  ModelSources sources;
};

int show(const model::Network& network, const Options& options, const Context& context) {
  const std::string text = model::write_network(network);
  if (!options.output.empty()) {
    const auto written = write_file(options.output, text);
    return written ? kDone : failed(context, written.error());
  }
  if (!context.json()) {
    print(text);
    return kDone;
  }
  const auto value = type::parse_yaml(text);
  if (!value) return failed(context, value.error());
  print_json(*value);
  return kDone;
}

int apply(const Options& options, const Context& context) {
  Diagnostics diagnostics;
  const auto catalog = load_catalog(options.sources, diagnostics);
  const auto network = load_valid_network(options.network, catalog, diagnostics);
  const auto transition = model::load_transition(options.transition, diagnostics);
  if (diagnostics.has_errors() || !network || !transition) return report_failure(context, diagnostics);
  print_diagnostics(diagnostics);
  const auto result = solve::predict(*network, *transition, catalog);
  return result ? show(*result, options, context) : failed(context, result.error());
}

}  // namespace

void add_apply(Verb& app, Context& context) {
  const auto options = std::make_shared<Options>();
  Verb& verb = add_verb(app, context, "apply", "predict the network that results from a transition",
                        "  segue diff -o t.yaml explore.yaml manual.yaml\n  segue apply explore.yaml t.yaml",
                        [options, &context] { return apply(*options, context); });
  verb.option("NETWORK", options->network, "a network or CND file; '-' is the empty network").required();
  verb.option("TRANSITION", options->transition, "a transition file").required();
  verb.option("-o,--output FILE", options->output, "write the network to a file");
  add_model_options(verb, options->sources);
}

}  // namespace segue::cli
