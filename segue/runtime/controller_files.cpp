// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/controller_files.hpp>

#include <segue/base/file.hpp>
#include <segue/base/input_file.hpp>
#include <segue/base/sha256.hpp>
#include <segue/base/text.hpp>
#include <segue/model/files.hpp>
#include <segue/model/validate.hpp>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <utility>

namespace segue::runtime {

namespace {

namespace fs = std::filesystem;

/// A stamp says whether a file has changed only where the file was not written shortly before it was read: a
/// later write within the same tick of the kernel's clock leaves the stamp as it was.
constexpr auto kTick = std::chrono::milliseconds(100);

/// Reads files and remembers what they were.
class FileReader {
 public:
  FileReader(const model::ReadFile& read, Diagnostics& diagnostics)
      : read_(read), diagnostics_(diagnostics) {}

  /// Nothing and a diagnostic where the file cannot be read.
  std::optional<std::string> read(const fs::path& path, bool is_model = false) {
    auto text = read_other(path, is_model);
    if (text) return std::move(*text);
    diagnostics_.error("unreadable-file", text.error().message, {path.string(), 0, 0});
    return std::nullopt;
  }

  /// A file that another one refers to.
  Result<std::string> read_other(const fs::path& path, bool is_model = false) {
    const auto now = std::chrono::system_clock::now();
    const auto stamp = stamp_of(path);
    if (!stamp) return stamp.error();
    auto text = read_ ? read_(path) : read_input_file(path);
    if (text) files_.push_back({path, sha256(*text), *stamp, now, is_model});
    return text;
  }

  /// Reports files that have changed since they were read.
  void check_unchanged() const {
    for (const LoadedFile& file : files_) {
      const auto stamp = stamp_of(file.path);
      if (stamp && *stamp == file.stamp) continue;
      diagnostics_.error("file-changed",
                         quote(file.path.string()) +
                             " was changed while the files were read; repeat this once it "
                             "is saved",
                         {file.path.string(), 0, 0});
    }
  }

  std::vector<LoadedFile> take() { return std::move(files_); }

 private:
  const model::ReadFile& read_;
  Diagnostics& diagnostics_;
  std::vector<LoadedFile> files_;
};

/// Files of the robot that match a pattern; a pattern without matches gives a warning.
std::vector<fs::path> files_of(const model::Robot& robot, const std::string& pattern, std::string_view what,
                               Diagnostics& diagnostics) {
  auto files = glob_files(robot.folder / pattern);
  if (files.empty()) {
    diagnostics.warning("no-such-file", "no file matches " + quote(pattern) + " (" + std::string(what) + ")",
                        robot.where);
  }
  return files;
}

/// Whether the content of a file may have changed, and if so, whether it has.
bool has_changed(const LoadedFile& file) {
  const auto stamp = stamp_of(file.path);
  if (stamp && *stamp == file.stamp && stamp->changed + kTick < file.read) return false;
  const auto text = read_input_file(file.path);
  return !text || sha256(*text) != file.digest;
}

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

}  // namespace

std::string_view to_string(FileChange::Kind kind) {
  static constexpr std::array<std::string_view, 3> kNames = {"changed", "added", "removed"};
  return kNames.at(static_cast<std::size_t>(kind));
}

std::optional<RobotFiles> read_robot_files(const fs::path& file, Diagnostics& diagnostics,
                                           const model::ReadFile& read) {
  FileReader reader(read, diagnostics);
  const auto text = reader.read(file);
  auto robot = text ? model::read_robot(*text, file.string(), diagnostics) : std::nullopt;
  if (!robot) return std::nullopt;
  ControllerSet set;
  set.fallback = robot->fallback;
  set.halt = robot->halt;
  const model::ReadFile further = [&](const fs::path& path) { return reader.read_other(path); };
  for (const auto& pattern : robot->controllers) {
    for (const auto& path : files_of(*robot, pattern, "controllers", diagnostics)) {
      const auto content = reader.read(path);
      auto network =
          content ? model::read_network(*content, path.string(), diagnostics, further) : std::nullopt;
      if (network) set.controllers.push_back(std::move(*network));
    }
  }
  for (const auto& pattern : robot->transitions) {
    for (const auto& path : files_of(*robot, pattern, "transitions", diagnostics)) {
      const auto content = reader.read(path);
      auto given = content ? model::read_transition(*content, path.string(), diagnostics) : std::nullopt;
      if (given) set.transitions.push_back(std::move(*given));
    }
  }
  model::check_names(set.transitions, diagnostics);
  for (const auto& pattern : robot->models) {
    for (const auto& path : files_of(*robot, pattern, "models", diagnostics))
      reader.read(path, true);
  }
  reader.check_unchanged();
  set.files = reader.take();
  return RobotFiles{std::move(*robot), std::move(set)};
}

ControllerFiles::ControllerFiles(fs::path file, const RobotFiles& started)
    : file_(std::move(file)), absolute_(fs::absolute(file_).lexically_normal()), robot_(started.robot) {
  std::ranges::copy_if(started.controllers.files, std::back_inserter(models_), &LoadedFile::is_model);
}

std::optional<ControllerSet> ControllerFiles::read(Diagnostics& diagnostics) const {
  Diagnostics found;
  auto files = read_robot_files(file_, found);
  if (files) {
    check_robot(files->robot, found);
    keep_models(files->controllers.files, found);
    // Not after errors: a part that the robot seems to lack may be in a file that could not be read.
    if (!found.has_errors()) found.append(model::validate(files->robot, files->controllers.controllers));
  }
  found.sort();
  diagnostics.append(found);
  if (!files || found.has_errors()) return std::nullopt;
  return std::move(files->controllers);
}

void ControllerFiles::check_robot(const model::Robot& now, Diagnostics& diagnostics) const {
  if (now.name != robot_.name) {
    diagnostics.error("other-robot",
                      "the robot is called " + quote(now.name) + " now, but " + quote(robot_.name) +
                          " runs; start the other one with `segue run`",
                      now.where);
  }
  const auto check = [&](bool equal, const std::string& key) {
    if (equal) return;
    diagnostics.warning("needs-restart",
                        quote(key) + " has changed, which takes effect when the robot is started again",
                        now.where);
  };
  check(now.hosts == robot_.hosts, "hosts");
  check(now.libraries == robot_.libraries, "libraries");
  check(now.models == robot_.models, "models");
  check(now.policies == robot_.policies, "policies");
  check(now.look_ahead == robot_.look_ahead, "look_ahead");
  check(now.pools == robot_.pools, "pools");
  check(now.pool_budget == robot_.pool_budget, "pool_budget");
  check(now.units == robot_.units, "units");
}

void ControllerFiles::keep_models(std::vector<LoadedFile>& files, Diagnostics& diagnostics) const {
  for (const LoadedFile& file : files) {
    const auto same = [&](const LoadedFile& old) {
      return old.path == file.path && old.digest == file.digest;
    };
    if (!file.is_model || std::ranges::any_of(models_, same)) continue;
    diagnostics.warning(
        "needs-restart",
        "this component model file has changed, which takes effect when the robot is started again",
        {file.path.string(), 0, 0});
  }
  std::erase_if(files, &LoadedFile::is_model);
  files.insert(files.end(), models_.begin(), models_.end());
}

std::vector<FileChange> ControllerFiles::changes(const std::vector<LoadedFile>& loaded) const {
  std::map<fs::path, FileChange::Kind> found;
  std::map<fs::path, const LoadedFile*> known;
  for (const LoadedFile& file : loaded) {
    known.emplace(file.path, &file);
    if (!is_there(file.path)) {
      found.emplace(file.path, FileChange::Kind::Removed);
    } else if (has_changed(file)) {
      found.emplace(file.path, FileChange::Kind::Changed);
    }
  }
  for (const auto* patterns : {&robot_.controllers, &robot_.transitions, &robot_.models}) {
    for (const std::string& pattern : *patterns) {
      for (const auto& path : glob_files(robot_.folder / pattern)) {
        if (!known.contains(path) && is_there(path)) found.emplace(path, FileChange::Kind::Added);
      }
    }
  }
  std::vector<FileChange> list;
  for (const auto& [path, kind] : found)
    list.push_back({path, kind});
  return list;
}

}  // namespace segue::runtime
