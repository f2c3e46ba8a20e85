// SPDX-License-Identifier: Apache-2.0
#include <segue/web/files_verbs.hpp>

#include <segue/base/file.hpp>
#include <segue/base/text.hpp>
#include <segue/mission/controllers.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission/pool_actions.hpp>
#include <segue/model/files.hpp>
#include <segue/model/validate.hpp>
#include <segue/type/scalar_text.hpp>
#include <segue/web/machine_files.hpp>
#include <segue/web/mission_files.hpp>

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

namespace segue::web {

namespace {

namespace fs = std::filesystem;
using type::Value;

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

/// Reads the files of a folder and no others: whoever may only look may name them in a text that is checked.
model::ReadFile reader_within(const FileFolder& folder, const fs::path& root) {
  return [&folder, root](const fs::path& file) -> Result<std::string> {
    auto content = folder.read(file.lexically_normal().lexically_relative(root).generic_string());
    if (!content) return content.error();
    return std::move(content->text);
  };
}

/// Whether whoever may only look may have this pattern looked at.
bool stays_within(const std::string& pattern, const fs::path& root, const FileFolder& folder) {
  const fs::path path(pattern);
  const bool leaves = path.is_absolute() || std::ranges::find(path, fs::path("..")) != path.end();
  if (leaves) return false;
  return std::ranges::all_of(glob_files(root / path), [&](const fs::path& file) {
    std::error_code ignored;
    const std::string name = file.lexically_relative(root).generic_string();
    return !fs::exists(fs::symlink_status(file, ignored)) || folder.stat(name).has_value();
  });
}

/// Takes from a robot that a text describes what names other files than `saved`, the robot's file, and those
/// in the folder; and libraries whose names could be paths, which have been reported.
void confine(model::Robot& robot, const model::Robot* saved, const FileFolder& folder, Diagnostics& found) {
  std::erase_if(robot.libraries, [](const std::string& name) { return !is_identifier(name); });
  using Patterns = std::vector<std::string>;
  for (Patterns model::Robot::*list :
       {&model::Robot::models, &model::Robot::controllers, &model::Robot::missions}) {
    std::erase_if(robot.*list, [&](const std::string& pattern) {
      const bool is_known =
          saved != nullptr && std::ranges::find(saved->*list, pattern) != (saved->*list).end();
      if (is_known || stays_within(pattern, robot.folder, folder)) return false;
      found.error("outside", quote(pattern) + " leads out of the robot's folder, so it is not looked at here",
                  robot.where);
      return true;
    });
  }
}

void add_those_of(const std::string& file, const Diagnostics& from, Diagnostics& to) {
  for (const Diagnostic& item : from.items()) {
    if (item.where.file == file) to.add(item);
  }
}

Result<Value> read_machine(const FileFolder& folder, const fs::path& robot, const std::string& path) {
  const auto machine = import_machine(folder, robot.parent_path(), files_of(robot), path);
  if (!machine) return machine.error();
  Value::List notes;
  for (const Diagnostic& item : machine->notes.items())
    notes.push_back(item.message);
  type::ValueMap folders;
  for (const auto& [state, place] : machine->folders)
    folders.append(state, place);
  return Value::map({{"path", path},
                     {"text", machine->text},
                     {"version", ""},
                     {"notes", std::move(notes)},
                     {"folders", std::move(folders)}});
}

/// Of machines of RAFCON, only the semantic data are written.
Result<void> may_change(const RobotFile& file) {
  if (file.kind != RobotFileKind::Machine) return {};
  return fail(ErrorCode::Unsupported,
              quote(file.path) + " is a state machine of RAFCON; save it as a new mission");
}

/// Checks that a file remains one of its kind, so that what a page has saved can be read again.
Result<void> stays_file(const RobotFile& file, const std::string& text) {
  const bool stays = file.kind != RobotFileKind::Mission || file.is_named ||
                     model::kind_of_file(file.place, text) == model::FileKind::Mission;
  if (stays) return {};
  return fail(ErrorCode::InvalidArgument,
              "a mission names itself, as in 'mission: fetch'; without that nothing was saved");
}

/// The robot file as a change of files requests it.
struct RobotChange {
  fs::path file;
  std::string text;  ///< as it is now, where `version` is empty
  std::string version;
  [[nodiscard]] bool is_wanted() const { return !version.empty(); }

  static Result<RobotChange> of(const Command& command, const fs::path& robot_file) {
    const auto text = command.text_or("robot_text", "");
    const auto version = command.text_or("robot_version", "");
    if (!text || !version) return text ? version.error() : text.error();
    if (text->empty() != version->empty())
      return fail(ErrorCode::InvalidArgument, "'robot_text' and 'robot_version' belong together");
    return RobotChange{robot_file, *text, *version};
  }

  /// Whether the robot names that network, which is there already.
  [[nodiscard]] bool names(const fs::path& network) const {
    Diagnostics ignored;
    const auto robot = is_wanted() ? model::read_robot_parts(text, file.string(), ignored) : robot_in(file);
    if (!robot) return false;
    const auto networks = networks_of(*robot);
    return std::ranges::find(networks, network) != networks.end();
  }

  [[nodiscard]] Result<void> apply(const FileFolder& folder) const {
    if (!is_wanted()) return {};
    const auto done = folder.replace(file.filename().string(), text, version);
    return done ? Result<void>() : Result<void>(done.error());
  }
};

/// Changes the robot file after another file has come to `place`, or calls `undo`.
Result<void> follow(const FileFolder& folder, const RobotChange& robot, const fs::path& place,
                    bool is_network, const std::function<void()>& undo) {
  Result<void> done;
  if (is_network && !robot.names(place))
    done =
        fail(ErrorCode::InvalidArgument, "the robot file does not name " + quote(place.filename().string()) +
                                             " among its controllers; nothing was changed");
  if (done) done = robot.apply(folder);
  if (!done) undo();
  return done;
}

/// The values of the named arguments of a command, which must be texts.
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
  const Lock lock(mutex_);
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
    const Lock lock(mutex_);
    if (catalog_ && !anew) return catalog_;
  }
  auto found = std::make_shared<const model::ComponentCatalog>(models_of_ ? models_of_(robot, diagnostics)
                                                                          : model::ComponentCatalog());
  const Lock lock(mutex_);
  catalog_ = found;
  return found;
}

Result<Value> FileVerbs::list(const Command& /*command*/) {
  const auto robot = robot_file();
  if (!robot) return robot.error();
  const auto folder = FileFolder::open(robot->parent_path());
  if (!folder) return folder.error();
  Value::List files;
  const RobotFiles found = files_of(*robot);
  for (const RobotFile& file : found.files) {
    const bool is_machine = file.kind == RobotFileKind::Machine;
    const auto good = is_machine ? Result<void>() : folder->stat(file.path);
    files.push_back(Value::map({{"path", file.path},
                                {"kind", std::string(to_string(file.kind))},
                                {"named", file.is_named},
                                {"problem", good ? std::string() : good.error().message}}));
  }
  return Value::map(
      {{"folder", robot->parent_path().string()}, {"complete", found.complete}, {"files", std::move(files)}});
}

Result<FileVerbs::Found> FileVerbs::find(const std::string& path) {
  const auto robot = robot_file();
  if (!robot) return robot.error();
  auto file = find_file(*robot, path);
  if (!file) return file.error();
  auto folder = FileFolder::open(robot->parent_path());
  if (!folder) return folder.error();
  return Found{std::move(*file), std::move(*folder), robot->parent_path()};
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
  if (file->kind == RobotFileKind::Machine) return read_machine(*folder, *robot, file->path);
  const auto content = folder->read(file->path);
  if (!content) return content.error();
  if (type::detail::valid_utf8(content->text) != content->text)  // JSON could not carry it unchanged
    return fail(ErrorCode::Unsupported, quote(file->path) + " is not UTF-8 text");
  return Value::map({{"path", file->path},
                     {"text", content->text},
                     {"version", content->version},
                     {"notes", Value::List()}});
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
  if (const auto may = may_change(*file); !may) return may.error();
  if (const auto stays = stays_file(*file, texts->at(1)); !stays) return stays.error();
  const Lock lock(saving_);
  const auto version = folder->replace(file->path, texts->at(1), texts->at(2));
  if (!version) return version.error();
  return Value::map({{"version", *version}});
}

Result<Value> FileVerbs::create(const Command& command) {
  const auto texts = texts_of(command, {"path", "text"});
  if (!texts) return texts.error();
  const std::string& path = texts->at(0);
  const auto robot = robot_file();
  if (!robot) return robot.error();
  if (const auto named = check_new_path(path); !named) return named.error();
  const auto kind = model::kind_of_file(path, texts->at(1));
  if (kind != model::FileKind::Network && kind != model::FileKind::Mission)
    return fail(ErrorCode::InvalidArgument, "only networks and missions can be created here");
  const auto change = RobotChange::of(command, *robot);
  if (!change) return change.error();
  const auto folder = FileFolder::open(robot->parent_path());
  if (!folder) return folder.error();
  const Lock lock(saving_);
  const auto version = folder->create(path, texts->at(1));
  if (!version) return version.error();
  const auto done = follow(*folder, *change, robot->parent_path() / path, kind == model::FileKind::Network,
                           [&] { (void)folder->remove(path, *version); });
  if (!done) return done.error();
  return Value::map({{"version", *version}});
}

Result<FileVerbs::Changed> FileVerbs::file_to_change(const Command& command) {
  const auto texts = texts_of(command, {"path", "version"});
  if (!texts) return texts.error();
  const auto robot = robot_file();
  if (!robot) return robot.error();
  auto file = find_file(*robot, texts->at(0));
  if (!file) return file.error();
  if (file->kind == RobotFileKind::Robot)
    return fail(ErrorCode::InvalidArgument, "the robot file stays where it is");
  if (const auto may = may_change(*file); !may) return may.error();
  auto folder = FileFolder::open(robot->parent_path());
  if (!folder) return folder.error();
  return Changed{*robot, std::move(*file), texts->at(1), std::move(*folder)};
}

Result<Value> FileVerbs::rename(const Command& command) {
  const auto to = command.text("to");
  if (!to) return to.error();
  const auto changed = file_to_change(command);
  if (!changed) return changed.error();
  if (const auto named = check_new_path(*to); !named) return named.error();
  const auto change = RobotChange::of(command, changed->robot);
  if (!change) return change.error();
  const Lock lock(saving_);
  if (auto done = changed->folder.rename(changed->file.path, *to, changed->version); !done)
    return done.error();
  const auto done = follow(changed->folder, *change, changed->robot.parent_path() / *to,
                           changed->file.kind == RobotFileKind::Network,
                           [&] { (void)changed->folder.rename(*to, changed->file.path, changed->version); });
  if (!done) return done.error();
  return Value();
}

Result<Value> FileVerbs::remove(const Command& command) {
  const auto changed = file_to_change(command);
  if (!changed) return changed.error();
  const auto change = RobotChange::of(command, changed->robot);
  if (!change) return change.error();
  const Lock lock(saving_);
  const auto content = changed->folder.read(changed->file.path);
  if (auto done = changed->folder.remove(changed->file.path, changed->version); !done) return done.error();
  const auto done = follow(changed->folder, *change, changed->file.place, false,
                           [&] { (void)changed->folder.create(changed->file.path, content->text); });
  if (!done) return done.error();
  return Value();
}

Result<Value> FileVerbs::libraries(const Command& command) {
  const auto texts = texts_of(command, {"path"});
  if (!texts) return texts.error();
  const auto robot = robot_file();
  if (!robot) return robot.error();
  const auto file = find_file(*robot, texts->at(0));
  if (!file) return file.error();
  const auto folder = FileFolder::open(robot->parent_path());
  if (!folder) return folder.error();
  return Value::map({{"libraries", libraries_for(*folder, files_of(*robot), file->path)}});
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
  const auto folder = FileFolder::open(robot->parent_path());
  if (!folder) return folder.error();
  const auto parts = robot_in(*robot);
  const std::string place = file->place.string();
  Diagnostics found;
  if (file->kind == RobotFileKind::Robot) {
    found = check_robot(place, texts->at(1), parts ? &*parts : nullptr, *folder);
  } else if (file->kind == RobotFileKind::Network) {
    found = check_network(parts ? &*parts : nullptr, place, texts->at(1),
                          reader_within(*folder, robot->parent_path()));
  } else {
    found =
        check_mission(parts ? &*parts : nullptr, *file, texts->at(1), within(*folder, robot->parent_path()));
  }
  return to_problems(std::move(found));
}

Value FileVerbs::to_problems(Diagnostics found) {
  found.sort();
  Value::List problems;
  for (const Diagnostic& item : found.items()) {
    problems.push_back(Value::map({{"severity", std::string(to_string(item.severity))},
                                   {"code", item.code},
                                   {"message", item.message},
                                   {"line", item.where.line},
                                   {"column", item.where.column}}));
  }
  return Value::map({{"problems", std::move(problems)}});
}

/// Problems of files that it includes are only counted: whoever may only look may not see what these say.
Diagnostics FileVerbs::check_network(const model::Robot* robot, const std::string& file,
                                     const std::string& text, const model::ReadFile& read) {
  Diagnostics all;
  const auto network = model::read_network_parts(text, file, all, read);
  const bool is_whole = !all.has_errors();
  Diagnostics elsewhere;
  if (network) {
    const auto known = catalog(robot != nullptr ? *robot : model::Robot{}, false, elsewhere);
    all.append(is_whole ? model::validate(*network, *known, model::Depth::Full)
                        : model::validate_references(*network, *known, model::Depth::Full));
  }
  Diagnostics found;
  add_those_of(file, all, found);
  if (const std::size_t others = all.error_count() - found.error_count(); others > 0)
    found.error("bad-include", "files that it includes have " + counted(others, "error"), {file, 1, 1});
  if (!network || !is_whole || robot == nullptr) return found;
  auto networks = other_networks(*robot, file);
  networks.push_back(*network);
  add_those_of(file, model::validate(*robot, networks), found);
  return found;
}

/// Checks a mission; its use of the robot counts where the robot file names it.
Diagnostics FileVerbs::check_mission(const model::Robot* robot, const RobotFile& file,
                                     const std::string& text, const mission::MayUse& may_use) {
  Diagnostics found = web::check_mission(file.place, text, may_use);
  if (robot == nullptr || !file.is_named || found.has_errors()) return found;
  Diagnostics ignored;
  auto mission = mission::load_mission_text(text, file.place, {}, ignored, may_use);
  if (!mission || !mission::needs_robot(*mission)) return found;
  const auto known = catalog(*robot, false, ignored);
  Diagnostics asked;
  mission::check_controllers(*mission, other_networks(*robot, {}), *known, asked);
  mission::check_pools(*mission, robot->pools, *known, asked);
  add_those_of(file.place.string(), asked, found);
  return found;
}

/// The text comes from a browser, so it names no other files than the robot's file does already, and those in
/// the robot's folder; and its models are nobody else's.
Diagnostics FileVerbs::check_robot(const std::string& file, const std::string& text,
                                   const model::Robot* saved, const FileFolder& folder) {
  Diagnostics found;
  auto robot = model::read_robot_parts(text, file, found);
  if (!robot) return found;
  const bool complete = !found.has_errors();
  confine(*robot, saved, folder, found);
  Diagnostics of_models;
  const auto known = std::make_shared<const model::ComponentCatalog>(
      models_of_ ? models_of_(*robot, of_models) : model::ComponentCatalog());
  add_those_of(file, of_models, found);
  for (const std::string& pattern : robot->controllers) {
    if (glob_files(robot->folder / pattern).empty())
      found.warning("no-such-file", "no file matches " + quote(pattern), robot->where);
  }
  // A missing host or controller may only be one that could not be read.
  if (!complete) return found;
  const auto networks = other_networks(*robot, {});
  Diagnostics of_robot = model::validate(*robot, networks);
  model::check_halt_members(*robot, networks, *known, of_robot);
  of_robot.append(model::validate(model::pool_network(robot->pools), *known, model::Depth::Full));
  add_those_of(file, of_robot, found);
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
