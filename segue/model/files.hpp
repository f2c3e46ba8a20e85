// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/base/result.hpp>
#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>
#include <segue/model/robot.hpp>
#include <segue/model/transition.hpp>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Reading and writing the files of formats.md. Readers report every problem with file, line and column, and
/// return nothing where there are errors; keys that are not known are warnings with a suggestion. Writers are
/// exact inverses.
namespace segue::model {

/// Reads a further file.
using ReadFile = std::function<Result<std::string>(const std::filesystem::path& file)>;

/// A network file: Segue's YAML or a Rock CND file, told apart by content. A network without a name gets
/// `file`'s stem. Files that it includes, and the property files whose sections its tasks name, are read with
/// `read`; without it, an `include` is an error.
std::optional<Network> read_network(std::string_view text, const std::string& file, Diagnostics& diagnostics,
                                    const ReadFile& read = {});
std::optional<Network> load_network(const std::filesystem::path& file, Diagnostics& diagnostics);
/// The parts of a network file that could be read, also where it has errors; nothing only where it cannot be
/// parsed or is not a network. To look for further problems with validate_references(), never to run.
std::optional<Network> read_network_parts(std::string_view text, const std::string& file,
                                          Diagnostics& diagnostics, const ReadFile& read = {});
std::string write_network(const Network& network);
/// Converts a process to and from its form in `deployments`, with its name under `process`.
type::Value to_value(const Deployment& deployment);
std::optional<Deployment> read_deployment(const type::Value& value, const std::string& file,
                                          Diagnostics& diagnostics);
/// One task as in a network file's `tasks` map; transition files hold these too.
type::Value to_value(const Task& task);

std::optional<Transition> read_transition(std::string_view text, const std::string& file,
                                          Diagnostics& diagnostics);
std::optional<Transition> load_transition(const std::filesystem::path& file, Diagnostics& diagnostics);
std::string write_transition(const Transition& transition);
/// The JSON of `segue diff`: from, to, order, actions, counts.
type::Value to_value(const Transition& transition);
/// One action as in a transition file.
type::Value to_value(const Action& action);

std::optional<Robot> read_robot(std::string_view text, const std::string& file, Diagnostics& diagnostics);
/// The parts of a robot file that could be read, also where it has errors; nothing only where it cannot be
/// parsed or is not a robot file.
std::optional<Robot> read_robot_parts(std::string_view text, const std::string& file,
                                      Diagnostics& diagnostics);
std::optional<Robot> load_robot(const std::filesystem::path& file, Diagnostics& diagnostics);

/// Component models: Segue's own file, Rock's exported model, or a Rock interface summary, told apart by
/// content; also typelib registries (.tlb). Adds to the catalog; true if the file had no errors.
bool read_components(std::string_view text, const std::string& file, ComponentCatalog& catalog,
                     Diagnostics& diagnostics);
bool load_components(const std::filesystem::path& file, ComponentCatalog& catalog, Diagnostics& diagnostics);
/// Copies the interfaces of parents (of Rock models), which may be in other files; to be called once after
/// all files are read.
void resolve_inheritance(ComponentCatalog& catalog, Diagnostics& diagnostics);
/// The models of `names` and the types they use, as a component model file.
std::string write_components(const ComponentCatalog& catalog, const std::vector<ComponentName>& names);
type::Value to_value(const ComponentModel& model);

enum class FileKind {
  Network,
  Cnd,
  Transition,
  Robot,
  Mission,
  TaskNetwork,
  Components,
  Typelib,
  StandIns,
  Pddl,         ///< a domain, a problem or a plan
  PlanMapping,  ///< of PDDL plans to missions
  Unknown
};
/// Determined by content (top-level keys), then by name.
FileKind kind_of_file(const std::filesystem::path& file, std::string_view text);

}  // namespace segue::model
