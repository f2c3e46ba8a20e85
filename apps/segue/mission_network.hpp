// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "command.hpp"
#include "run_files.hpp"

/// `segue mission` for task networks.
namespace segue::cli {

struct NetworkOptions {
  std::string mode;  ///< "" is concurrent
  std::string clock = "real";
  std::string order = "epoch";
  std::uint64_t seed = 0;
  std::uint32_t workers = 0;
  std::uint32_t world_copies = 0;
  bool strict = false;
  std::vector<std::string> resources;  ///< NAME=COUNT
  RunFiles files;
  bool show = true;  ///< what it did, on standard output
};

/// The options of a run that only task networks have.
void add_network_options(Verb& verb, NetworkOptions& options);

/// Whether the file is a task network rather than a mission: JSON with nodes at its top.
bool is_task_network(const std::filesystem::path& file);

/// Runs it with simulated nodes. SIGINT and SIGTERM preempt it.
int run_task_network(const std::string& file, const NetworkOptions& options, const Context& context);

struct PddlOptions {
  std::vector<std::string> files;  ///< domain, problem, plan
  std::string output;
};
int import_pddl(const PddlOptions& options, const Context& context);

}  // namespace segue::cli
