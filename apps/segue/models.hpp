// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>
#include <segue/model/robot.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "command.hpp"

/// Files that verbs read without a runtime.
namespace segue::cli {

/// The sources of component models besides the installed libraries.
struct ModelSources {
  std::vector<std::string> patterns;  ///< --models
  std::string robot_file;             ///< --robot-file
};
void add_model_options(Verb& verb, ModelSources& sources);

/// The models of all installed libraries, of the patterns, and of what the robot file names.
model::ComponentCatalog load_catalog(const ModelSources& sources, Diagnostics& diagnostics);
/// Adds the models of libraries and the model files that the robot file names.
void add_robot_models(const model::Robot& robot, model::ComponentCatalog& catalog, Diagnostics& diagnostics);

/// The files that match a pattern of the robot file; a warning if there are none.
std::vector<std::filesystem::path> files_of(const model::Robot& robot, const std::string& pattern,
                                            Diagnostics& diagnostics);

/// Reads a network file and validates its structure; of several files, joined by '+', their union, where they
/// can run at once. '-' is the empty network, as is 'empty' if there is no such file.
std::optional<model::Network> load_valid_network(const std::string& files,
                                                 const model::ComponentCatalog& catalog,
                                                 Diagnostics& diagnostics);

/// The text of a network file for a runtime, which cannot read the files that it refers to: as it is, or
/// where it includes files or names sections of property files, the network that these make.
Result<std::string> network_text(const std::string& file);

/// Prints diagnostics on standard error, and with JSON on standard output too. Returns kFailed.
int report_failure(const Context& context, Diagnostics& diagnostics);
/// Prints the diagnostics that the error carries, in the same way.
int report_failure(const Context& context, const Error& error);

}  // namespace segue::cli
