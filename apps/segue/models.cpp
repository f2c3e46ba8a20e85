// SPDX-License-Identifier: Apache-2.0
#include "models.hpp"

#include <segue/base/file.hpp>
#include <segue/base/input_file.hpp>
#include <segue/base/text.hpp>
#include <segue/model/controller_names.hpp>
#include <segue/model/files.hpp>
#include <segue/model/validate.hpp>
#include <segue/solve/combine.hpp>
#include <segue/task_host/component_library.hpp>

#include <algorithm>

#include "output.hpp"

namespace segue::cli {

namespace {

void add_installed(model::ComponentCatalog& catalog, Diagnostics& diagnostics) {
  for (const std::string& library : task_host::installed_libraries()) {
    const auto done = task_host::read_library_models(library, catalog);
    if (!done) diagnostics.warning("unreadable-library", done.error().message, done.error().where);
  }
}

void add_pattern(const std::filesystem::path& pattern, const SourceLocation& where,
                 model::ComponentCatalog& catalog, Diagnostics& diagnostics) {
  const auto files = glob_files(pattern);
  if (files.empty()) {
    diagnostics.error("no-such-file", "no component model file matches " + quote(pattern.native()), where);
  }
  for (const auto& file : files)
    model::load_components(file, catalog, diagnostics);
}

}  // namespace

void add_model_options(Verb& verb, ModelSources& sources) {
  verb.option("--models PATTERN", sources.patterns, "further component model files; may contain * and ?")
      .takes_one_at_a_time();
  verb.option("--robot-file FILE", sources.robot_file,
              "also use the libraries and models of this robot file");
}

void add_robot_models(const model::Robot& robot, model::ComponentCatalog& catalog, Diagnostics& diagnostics) {
  for (const std::string& library : robot.libraries) {
    const auto done = task_host::read_library_models(library, catalog);
    if (!done) diagnostics.error("unknown-library", done.error().message, robot.where);
  }
  for (const std::string& pattern : robot.models)
    add_pattern(robot.folder / pattern, robot.where, catalog, diagnostics);
}

model::ComponentCatalog load_catalog(const ModelSources& sources, Diagnostics& diagnostics) {
  model::ComponentCatalog catalog;
  add_installed(catalog, diagnostics);
  for (const std::string& pattern : sources.patterns)
    add_pattern(pattern, {}, catalog, diagnostics);
  if (!sources.robot_file.empty()) {
    const auto robot = model::load_robot(sources.robot_file, diagnostics);
    if (robot) add_robot_models(*robot, catalog, diagnostics);
  }
  model::resolve_inheritance(catalog, diagnostics);
  return catalog;
}

std::vector<std::filesystem::path> files_of(const model::Robot& robot, const std::string& pattern,
                                            Diagnostics& diagnostics) {
  auto files = glob_files(robot.folder / pattern);
  if (files.empty()) {
    diagnostics.warning("no-such-file",
                        "no file matches " + quote(pattern) + " in " + quote(robot.folder.native()),
                        robot.where);
  }
  return files;
}

namespace {

/// The files that an argument names: one, or several joined by '+'.
std::vector<std::string> files_in(const std::string& argument) {
  if (std::filesystem::exists(argument)) return {argument};
  std::vector<std::string> files;
  std::size_t begin = 0;
  for (std::size_t end = 0; end != std::string::npos; begin = end + 1) {
    end = argument.find(model::kControllerSeparator, begin);
    files.push_back(argument.substr(begin, end - begin));
  }
  return files;
}

std::optional<model::Network> load_valid_file(const std::string& file, const model::ComponentCatalog& catalog,
                                              Diagnostics& diagnostics) {
  if (file == "-" || (file == "empty" && !std::filesystem::exists(file))) return model::Network{};
  auto network = model::load_network(file, diagnostics);
  if (!network) return network;
  const Diagnostics found = model::validate(*network, catalog, model::Depth::Structure);
  diagnostics.append(found);
  if (found.has_errors()) return std::nullopt;
  return network;
}

}  // namespace

std::optional<model::Network> load_valid_network(const std::string& files,
                                                 const model::ComponentCatalog& catalog,
                                                 Diagnostics& diagnostics) {
  std::vector<model::Network> networks;
  for (const std::string& file : files_in(files)) {
    auto network = load_valid_file(file, catalog, diagnostics);
    if (!network) return std::nullopt;
    networks.push_back(std::move(*network));
  }
  if (networks.size() == 1) return std::move(networks.front());
  std::ranges::sort(networks, {}, &model::Network::name);
  auto all = solve::combine(networks, catalog);
  if (all) return std::move(*all);
  diagnostics.error(std::string(to_string(all.error().code)), to_string(all.error()), {});
  return std::nullopt;
}

Result<std::string> network_text(const std::string& file) {
  auto text = read_input_file(file);
  if (!text) return text;
  bool refers_to_others = false;
  const model::ReadFile read = [&](const std::filesystem::path& other) {
    refers_to_others = true;
    return read_input_file(other);
  };
  Diagnostics found;
  const auto network = model::read_network(*text, file, found, read);
  if (!refers_to_others) return text;  // the runtime reports what is wrong with it
  if (!network) return found.to_error();
  return model::write_network(*network);
}

int report_failure(const Context& context, Diagnostics& diagnostics) {
  diagnostics.sort();
  print_diagnostics(diagnostics);
  if (context.json()) print_json(to_value(diagnostics));
  return kFailed;
}

int report_failure(const Context& context, const Error& error) {
  Diagnostics diagnostics = diagnostics_of(error);
  return report_failure(context, diagnostics);
}

}  // namespace segue::cli
