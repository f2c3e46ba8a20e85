// SPDX-License-Identifier: Apache-2.0
#include <segue/web/files_verbs.hpp>

#include <segue/base/file.hpp>
#include <segue/base/input_file.hpp>
#include <segue/base/text.hpp>
#include <segue/model/files.hpp>
#include <segue/model/validate.hpp>
#include <segue/type/scalar_text.hpp>
#include <segue/web/files_folder.hpp>

#include <algorithm>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace segue::web {

namespace {

namespace fs = std::filesystem;
using type::Value;

/// The networks that the robot file names.
std::vector<fs::path> networks_of(const model::Robot& robot) {
  std::set<fs::path> files;
  for (const std::string& pattern : robot.controllers) {
    for (const fs::path& file : glob_files(robot.folder / pattern))
      files.insert(file.lexically_normal());
  }
  return {files.begin(), files.end()};
}

/// Whatever can be read of it: a robot file with errors must be shown, too.
std::optional<model::Robot> robot_in(const fs::path& file) {
  Diagnostics ignored;
  const auto text = read_input_file(file);
  return text ? model::read_robot_parts(*text, file.string(), ignored) : std::nullopt;
}

struct EditedFile {
  std::string path;  ///< within the folder
  fs::path place;
  bool is_robot = false;
};

/// The robot file first.
std::vector<EditedFile> files_of(const fs::path& robot_file) {
  const fs::path folder = robot_file.parent_path();
  std::vector<EditedFile> files = {{robot_file.filename().string(), robot_file, true}};
  const auto robot = robot_in(robot_file);
  for (const fs::path& file : robot ? networks_of(*robot) : std::vector<fs::path>{}) {
    if (file != robot_file) files.push_back({file.lexically_relative(folder).generic_string(), file});
  }
  return files;
}

/// NotFound where the robot has no such file, whatever else is there.
Result<EditedFile> find_file(const fs::path& robot_file, const std::string& path) {
  for (EditedFile& file : files_of(robot_file)) {
    if (file.path == path) return std::move(file);
  }
  return fail(ErrorCode::NotFound,
              quote(path) + " is no file of the robot: neither its robot file nor one of its controllers");
}

/// The networks of the robot but that of `file`; those with errors are left out.
std::vector<model::Network> other_networks(const model::Robot& robot, const std::string& file) {
  std::vector<model::Network> networks;
  Diagnostics ignored;
  for (const fs::path& place : networks_of(robot)) {
    if (place.string() == file) continue;
    if (auto network = model::load_network(place, ignored)) networks.push_back(std::move(*network));
  }
  return networks;
}

void add_those_of(const std::string& file, const Diagnostics& from, Diagnostics& to) {
  for (const Diagnostic& item : from.items()) {
    if (item.where.file == file) to.add(item);
  }
}

Value to_problem(const Diagnostic& item) {
  return Value::map({{"severity", std::string(to_string(item.severity))},
                     {"code", item.code},
                     {"message", item.message},
                     {"line", item.where.line},
                     {"column", item.where.column}});
}

/// What texts of a command a verb needs.
Result<std::vector<std::string>> texts_of(const Command& command, std::initializer_list<const char*> names) {
  std::vector<std::string> texts;
  for (const char* name : names) {
    auto text = command.text(name);
    if (!text) return text.error();
    texts.push_back(std::move(*text));
  }
  return texts;
}

}  // namespace

Result<fs::path> FileVerbs::robot_file() {
  const auto link = link_.get();
  const auto status = link ? link->robot->status() : Result<Value>(link.error());
  if (link && !status) link_.failed(link->generation, status.error());
  const std::lock_guard lock(mutex_);
  if (!status) return last_file_.empty() ? Result<fs::path>(status.error()) : Result<fs::path>(last_file_);
  const Value* file = status->find("file");
  if (file == nullptr || !file->is_string())
    return fail(ErrorCode::Unsupported, "the robot that runs has no files that could be edited");
  last_file_ = fs::path(file->as_string()).lexically_normal();
  return last_file_;
}

std::shared_ptr<const model::ComponentCatalog> FileVerbs::catalog(const model::Robot& robot, bool anew,
                                                                  Diagnostics& diagnostics) {
  {
    const std::lock_guard lock(mutex_);
    if (catalog_ && !anew) return catalog_;
  }
  auto found = std::make_shared<const model::ComponentCatalog>(models_of_ ? models_of_(robot, diagnostics)
                                                                          : model::ComponentCatalog());
  const std::lock_guard lock(mutex_);
  catalog_ = found;
  return found;
}

Result<Value> FileVerbs::list(const Command& /*command*/) {
  const auto robot = robot_file();
  if (!robot) return robot.error();
  const auto folder = FileFolder::open(robot->parent_path());
  if (!folder) return folder.error();
  Value::List files;
  for (const EditedFile& file : files_of(*robot)) {
    const auto good = folder->look(file.path);
    files.push_back(Value::map({{"path", file.path},
                                {"kind", file.is_robot ? "robot" : "network"},
                                {"problem", good ? std::string() : good.error().message}}));
  }
  return Value::map({{"folder", robot->parent_path().string()}, {"files", std::move(files)}});
}

Result<Value> FileVerbs::read(const Command& command) {
  const auto texts = texts_of(command, {"path"});
  if (!texts) return texts.error();
  const auto robot = robot_file();
  if (!robot) return robot.error();
  const auto file = find_file(*robot, texts->at(0));
  if (!file) return file.error();
  const auto folder = FileFolder::open(robot->parent_path());
  if (!folder) return folder.error();
  const auto content = folder->read(file->path);
  if (!content) return content.error();
  if (type::detail::valid_utf8(content->text) != content->text)  // JSON could not carry it unchanged
    return fail(ErrorCode::Unsupported, quote(file->path) + " is no text in UTF-8");
  return Value::map({{"path", file->path}, {"text", content->text}, {"version", content->version}});
}

Result<Value> FileVerbs::save(const Command& command) {
  const auto texts = texts_of(command, {"path", "text", "version"});
  if (!texts) return texts.error();
  const auto robot = robot_file();
  if (!robot) return robot.error();
  const auto file = find_file(*robot, texts->at(0));
  if (!file) return file.error();
  const auto folder = FileFolder::open(robot->parent_path());
  if (!folder) return folder.error();
  const std::lock_guard lock(saving_);
  const auto version = folder->replace(file->path, texts->at(1), texts->at(2));
  if (!version) return version.error();
  return Value::map({{"version", *version}});
}

Result<Value> FileVerbs::check(const Command& command) {
  const auto texts = texts_of(command, {"path", "text"});
  if (!texts) return texts.error();
  if (texts->at(1).size() > FileFolder::kLongestFile)
    return fail(ErrorCode::ResourceExhausted, "the text is too long to be checked here");
  const auto robot = robot_file();
  if (!robot) return robot.error();
  const auto file = find_file(*robot, texts->at(0));
  if (!file) return file.error();
  const auto parts = robot_in(*robot);
  Diagnostics found = file->is_robot
                          ? check_robot(file->place.string(), texts->at(1))
                          : check_network(parts ? &*parts : nullptr, file->place.string(), texts->at(1));
  found.sort();
  Value::List problems;
  for (const Diagnostic& item : found.items())
    problems.push_back(to_problem(item));
  return Value::map({{"problems", std::move(problems)}});
}

Diagnostics FileVerbs::check_network(const model::Robot* robot, const std::string& file,
                                     const std::string& text) {
  Diagnostics found;
  const auto network = model::read_network_parts(text, file, found);
  if (!network) return found;
  Diagnostics elsewhere;
  const auto known = catalog(robot != nullptr ? *robot : model::Robot{}, false, elsewhere);
  if (found.has_errors()) {
    found.append(model::validate_references(*network, *known, model::Depth::Full));
    return found;
  }
  found.append(model::validate(*network, *known, model::Depth::Full));
  if (robot == nullptr) return found;
  auto networks = other_networks(*robot, file);
  networks.push_back(*network);
  add_those_of(file, model::validate(*robot, networks), found);
  return found;
}

Diagnostics FileVerbs::check_robot(const std::string& file, const std::string& text) {
  Diagnostics found;
  const auto robot = model::read_robot_parts(text, file, found);
  if (!robot) return found;
  const bool complete = !found.has_errors();
  const auto known = catalog(*robot, true, found);
  for (const std::string& pattern : robot->controllers) {
    if (glob_files(robot->folder / pattern).empty())
      found.warning("no-such-file", "no file matches " + quote(pattern), robot->where);
  }
  // Where something could not be read, that a host or controller is missing may follow from it.
  if (!complete) return found;
  add_those_of(file, model::validate(*robot, other_networks(*robot, {})), found);
  add_those_of(file, model::validate(model::pool_network(robot->pools), *known, model::Depth::Full), found);
  return found;
}

Result<Value> FileVerbs::models(const Command& /*command*/) {
  const auto file = robot_file();
  if (!file) return file.error();
  const auto robot = robot_in(*file);
  Diagnostics ignored;
  const auto known = catalog(robot ? *robot : model::Robot{}, true, ignored);
  type::ValueMap components;
  for (const model::ComponentModel* model : known->all())
    components.append(model->name.str(), model::to_value(*model));
  return Value::map({{"components", std::move(components)}});
}

}  // namespace segue::web
