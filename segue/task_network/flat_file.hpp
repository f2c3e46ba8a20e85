// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/task_network/simulated_environment.hpp>
#include <segue/task_network/task_network.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::task_network {

/// A task network with the simulated behaviour of its nodes.
struct FlatNetwork {
  TaskNetwork network;
  std::vector<Trial> trials;  ///< by node
};

/// Reads the JSON of a flat task network. Nodes are ordered by `seq`, else as they are written. Every problem
/// becomes a diagnostic with its place; if there are errors, nothing is returned. Unknown keys are warnings.
/// Nodes that declare neither facts nor resources are opaque.
std::optional<FlatNetwork> read_flat_network(std::string_view text, const std::string& file,
                                             Diagnostics& diagnostics);
/// Reads a file with the JSON of a flat task network; one that cannot be read is the diagnostic
/// `unreadable-file`. Blocks.
std::optional<FlatNetwork> load_flat_network(const std::filesystem::path& file, Diagnostics& diagnostics);

/// JSON that reads as the same network.
std::string write_flat_network(const FlatNetwork& flat);

/// Reports claims of units that no earlier node can have left or created (`missing-resource`).
void check_resources(const TaskNetwork& network, const std::string& file, Diagnostics& diagnostics);

}  // namespace segue::task_network
