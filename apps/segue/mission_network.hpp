// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "command.hpp"

/// `segue mission` for task networks.
namespace segue::cli {

/// What only a concurrent run has, and mostly only that of a task network.
struct NetworkOptions {
  std::string order = "epoch";
  std::uint64_t seed = 0;
  std::uint32_t workers = 0;
  std::uint32_t world_copies = 0;
  bool strict = false;
  std::vector<std::string> resources;  ///< NAME=COUNT
};

/// The options of a run that only task networks have.
void add_network_options(Verb& verb, NetworkOptions& options);

struct PddlOptions {
  std::vector<std::string> files;  ///< domain, problem, plan
  std::string output;
};
int import_pddl(const PddlOptions& options, const Context& context);

}  // namespace segue::cli
