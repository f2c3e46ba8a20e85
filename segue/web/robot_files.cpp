// SPDX-License-Identifier: Apache-2.0
#include <segue/web/robot_files.hpp>

#include <segue/base/file.hpp>
#include <segue/base/input_file.hpp>
#include <segue/base/text.hpp>
#include <segue/model/files.hpp>
#include <segue/web/files_folder.hpp>

#include <algorithm>
#include <set>
#include <system_error>
#include <utility>

namespace segue::web {

namespace {

namespace fs = std::filesystem;

std::set<fs::path> matches(const model::Robot& robot, const std::vector<std::string>& patterns) {
  std::set<fs::path> files;
  for (const std::string& pattern : patterns) {
    for (const fs::path& file : glob_files(robot.folder / pattern))
      files.insert(file.lexically_normal());
  }
  return files;
}

bool is_yaml(const fs::path& file) {
  return file.extension() == ".yaml" || file.extension() == ".yml";
}

bool is_hidden(const fs::path& path) {
  return std::ranges::any_of(path, [](const fs::path& part) { return part.string().starts_with('.'); });
}

bool is_mission(const FileFolder& folder, const std::string& path) {
  if (!is_yaml(path) || is_hidden(path)) return false;
  const auto content = folder.read(path);
  return content && model::kind_of_file(path, content->text) == model::FileKind::Mission;
}

bool is_machine(const FileFolder& folder, const std::string& path) {
  return !is_hidden(path) && folder.stat(path + "/statemachine.json");
}

std::vector<RobotFile> named_files(const fs::path& robot_file) {
  const fs::path folder = robot_file.parent_path();
  std::vector<RobotFile> files = {{robot_file.filename().string(), robot_file, RobotFileKind::Robot, true}};
  const auto robot = robot_in(robot_file);
  if (!robot) return files;
  const auto add = [&](const std::set<fs::path>& places, RobotFileKind kind) {
    for (const fs::path& place : places) {
      if (std::ranges::find(files, place, &RobotFile::place) == files.end())
        files.push_back({place.lexically_relative(folder).generic_string(), place, kind, true});
    }
  };
  add(matches(*robot, robot->controllers), RobotFileKind::Network);
  add(matches(*robot, robot->missions), RobotFileKind::Mission);
  return files;
}

/// Looks through a folder and those in it.
class Search {
 public:
  Search(const FileFolder& folder, const fs::path& root, RobotFiles& found)
      : folder_(folder), root_(root), found_(found) {
    for (const RobotFile& file : found_.files)
      known_.insert(file.path);
  }

  void run() { look_in(root_, 0); }

 private:
  void look_in(const fs::path& place, int depth) {
    std::vector<fs::path> entries;
    std::error_code error;
    for (fs::directory_iterator entry(place, error), end; !error && entry != end; entry.increment(error)) {
      if (++searched_ > kMostSearchedEntries) break;
      entries.push_back(entry->path());
    }
    std::ranges::sort(entries);
    for (const fs::path& entry : entries) {
      found_.complete = found_.complete && searched_ <= kMostSearchedEntries;
      if (!entry.filename().string().starts_with('.')) take(entry, depth);
    }
  }

  void take(const fs::path& place, int depth) {
    std::error_code error;
    const auto type = fs::symlink_status(place, error).type();
    const std::string path = place.lexically_relative(root_).generic_string();
    if (type == fs::file_type::regular) {
      if (is_yaml(place) && known_.count(path) == 0 && may_read() && is_mission(folder_, path))
        add({path, place, RobotFileKind::Mission, false});
    } else if (type == fs::file_type::directory) {
      if (is_machine(folder_, path)) return add({path, place, RobotFileKind::Machine, false});
      if (depth + 1 < kDeepestSearch) return look_in(place, depth + 1);
      found_.complete = false;
    }
  }

  bool may_read() {
    const bool may = ++read_ <= kMostReadFiles;
    found_.complete = found_.complete && may;
    return may;
  }

  void add(RobotFile file) {
    const bool may = ++listed_ <= kMostListedFiles;
    found_.complete = found_.complete && may;
    if (may) found_.files.push_back(std::move(file));
  }

  const FileFolder& folder_;
  const fs::path& root_;
  RobotFiles& found_;
  std::set<std::string> known_;
  std::size_t searched_ = 0;
  std::size_t read_ = 0;
  std::size_t listed_ = 0;
};

}  // namespace

std::string_view to_string(RobotFileKind kind) {
  switch (kind) {
    case RobotFileKind::Robot:
      return "robot";
    case RobotFileKind::Network:
      return "network";
    case RobotFileKind::Mission:
      return "mission";
    case RobotFileKind::Machine:
      break;
  }
  return "rafcon";
}

std::optional<model::Robot> robot_in(const fs::path& file) {
  Diagnostics ignored;
  const auto text = read_input_file(file);
  return text ? model::read_robot_parts(*text, file.string(), ignored) : std::nullopt;
}

std::vector<fs::path> networks_of(const model::Robot& robot) {
  const auto files = matches(robot, robot.controllers);
  return {files.begin(), files.end()};
}

RobotFiles files_of(const fs::path& robot_file) {
  RobotFiles found;
  found.files = named_files(robot_file);
  const fs::path root = robot_file.parent_path();
  if (const auto folder = FileFolder::open(root)) Search(*folder, root, found).run();
  return found;
}

Result<RobotFile> find_file(const fs::path& robot_file, const std::string& path) {
  for (RobotFile& file : named_files(robot_file)) {
    if (file.path == path) return std::move(file);
  }
  const fs::path root = robot_file.parent_path();
  const auto folder = FileFolder::open(root);
  if (!folder) return folder.error();
  if (is_mission(*folder, path)) return RobotFile{path, root / path, RobotFileKind::Mission, false};
  if (is_machine(*folder, path)) return RobotFile{path, root / path, RobotFileKind::Machine, false};
  return fail(ErrorCode::NotFound,
              quote(path) +
                  " is not a file of the robot: neither its robot file, nor one of its controllers, "
                  "nor a mission in its folder");
}

Result<void> check_new_path(const std::string& path) {
  const auto wrong = [&](const std::string& why) {
    return fail(ErrorCode::InvalidArgument, quote(path) + " cannot be the name of a file: " + why);
  };
  if (!is_yaml(fs::path(path))) return wrong("it must end in .yaml");
  for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 1) {
    end = path.find('/', begin);
    if (!is_identifier(path.substr(begin, end == std::string::npos ? end : end - begin)))
      return wrong(
          "it must be named within the robot's folder, by letters, digits, '_', '-', '.' and ':', such as "
          "missions/fetch.yaml");
  }
  return {};
}

}  // namespace segue::web
