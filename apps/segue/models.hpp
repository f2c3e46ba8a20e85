// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/model/component.hpp>
#include <segue/model/network.hpp>
#include <segue/model/robot.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "command.hpp"

/// Files that verbs read without a runtime.
namespace segue::cli {

/// Where component models come from beside the installed libraries.
struct ModelSources {
  std::vector<std::string> patterns;  ///< --models
  std::string robot_file;             ///< --robot-file
};
void add_model_options(Verb& verb, ModelSources& sources);

/// The models of all installed libraries, of the patterns, and of what the robot file names.
model::ComponentCatalog load_catalog(const ModelSources& sources, Diagnostics& diagnostics);
/// Adds the models of libraries and the model files that the robot file names.
void add_robot_models(const model::Robot& robot, model::ComponentCatalog& catalog, Diagnostics& diagnostics);

/// Files that a robot file's pattern names; a warning where there are none.
std::vector<std::filesystem::path> files_of(const model::Robot& robot, const std::string& pattern,
                                            Diagnostics& diagnostics);

/// A network file; '-' and, where no such file is there, 'empty' are the network without anything. Its
/// structure is valid.
std::optional<model::Network> load_valid_network(const std::string& file,
                                                 const model::ComponentCatalog& catalog,
                                                 Diagnostics& diagnostics);

/// Diagnostics on standard error, in JSON on standard output too, where there are errors; then kFailed.
int report_failure(const Context& context, Diagnostics& diagnostics);

}  // namespace segue::cli
