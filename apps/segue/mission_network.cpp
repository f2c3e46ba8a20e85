// SPDX-License-Identifier: Apache-2.0
#include "mission_network.hpp"

#include <segue/base/file.hpp>
#include <segue/cdtn/flat_file.hpp>
#include <segue/pddl/pddl.hpp>

#include "models.hpp"
#include "output.hpp"

namespace segue::cli {

int import_pddl(const PddlOptions& options, const Context& context) {
  Diagnostics diagnostics;
  auto network = pddl::load_pddl(options.files[0], options.files[1], options.files[2], diagnostics);
  if (!network) return report_failure(context, diagnostics);
  print_diagnostics(diagnostics);
  const std::string text = cdtn::write_flat_network({std::move(*network), {}});
  if (options.output.empty()) {
    print(text);
    return kDone;
  }
  const auto written = write_file(options.output, text);
  return written ? kDone : failed(context, written.error());
}

void add_network_options(Verb& verb, NetworkOptions& options) {
  verb.option("--order ORDER", options.order,
              "of a task network: epoch (default) keeps the whole final world, goal only its goal")
      .one_of({"epoch", "goal"});
  verb.option("--seed N", options.seed,
              "vary durations of simulated nodes, reproducibly for each number; 0: as expected");
  verb.option("--workers N", options.workers, "nodes that run at the same time; 0: any number");
  verb.option("--world-copies N", options.world_copies, "projected worlds at the same time; 0: any number");
  verb.option("--resource NAME=COUNT", options.resources,
              "how many units of a resource exist, such as process:planner=2");
  verb.flag("--strict", options.strict, "irreversible nodes wait for all earlier ones that may fail");
}

}  // namespace segue::cli
