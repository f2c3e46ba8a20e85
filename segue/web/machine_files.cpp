// SPDX-License-Identifier: Apache-2.0
#include <segue/web/machine_files.hpp>

#include <segue/base/text.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/rafcon/rafcon.hpp>

#include <algorithm>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace segue::web {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestMachine = 50'000'000;

/// A machine, where the robot's files are.
struct MachinePlace {
  const FileFolder& folder;
  const fs::path& root;
  const RobotFiles& files;
  const std::string& path;
};

/// Any folder around machines may be an entry of RAFCON's library paths.
std::vector<mission::RafconLibraryPath> library_paths(const MachinePlace& place) {
  std::set<fs::path> folders;
  for (const RobotFile& file : place.files.files) {
    if (file.kind != RobotFileKind::Machine) continue;
    for (fs::path around = fs::path(file.path).parent_path();; around = around.parent_path()) {
      folders.insert(place.root / around);
      if (around.empty()) break;
    }
  }
  std::vector<mission::RafconLibraryPath> libraries;
  for (const fs::path& one : folders)
    libraries.push_back({one.filename().string(), one});
  for (const fs::path& one : folders)
    libraries.push_back({"", one});
  return libraries;
}

std::optional<mission::RafconImport> import(const MachinePlace& place, const ChangedFile* changed,
                                            Diagnostics& diagnostics) {
  std::size_t bytes = 0;
  const auto read = [&](const fs::path& file) -> Result<std::string> {
    const std::string name = file.lexically_relative(place.root).generic_string();
    if (changed != nullptr && changed->path == name) return changed->text;
    auto content = place.folder.read(name);
    if (!content) return content.error();
    bytes += content->text.size();
    if (bytes > kLargestMachine)
      return fail(ErrorCode::ResourceExhausted,
                  "the machine is too large to be shown here; use segue mission import --rafcon");
    return std::move(content->text);
  };
  return mission::import_rafcon(place.root / place.path, library_paths(place), diagnostics, read);
}

/// Of the states of the machine itself, not those in libraries.
std::map<std::string, std::string> folders_of(const mission::Mission& mission, const fs::path& machine) {
  std::map<std::string, std::string> folders;
  std::vector<std::optional<std::string>> paths;  // by state; parents come first
  for (const mission::State& state : mission.states) {
    std::optional<std::string> path;
    if (paths.empty())
      path = "";
    else if (state.parent != mission::kNoState && paths[state.parent])
      path = (paths[state.parent]->empty() ? "" : *paths[state.parent] + "/") + state.id.str();
    if (path) {
      const fs::path folder = fs::path(state.where.file).parent_path().lexically_relative(machine);
      folders[*path] = folder == "." ? "" : folder.generic_string();
    }
    paths.push_back(std::move(path));
  }
  return folders;
}

}  // namespace

Result<ImportedMachine> import_machine(const FileFolder& folder, const fs::path& root,
                                       const RobotFiles& files, const std::string& path) {
  ImportedMachine imported;
  const auto machine = import({folder, root, files, path}, nullptr, imported.notes);
  if (!machine) return imported.notes.to_error();
  imported.text = mission::write_mission(machine->mission);
  imported.folders = folders_of(machine->mission, root / path);
  if (imported.text.size() > FileFolder::kLongestFile)
    return fail(ErrorCode::ResourceExhausted,
                "the mission that the machine becomes is too large to be edited here (" +
                    format_size(imported.text.size()) + "); use segue mission import --rafcon");
  return imported;
}

Diagnostics errors_by_change(const FileFolder& folder, const fs::path& root, const RobotFiles& files,
                             const std::string& path, const ChangedFile& changed) {
  const auto errors = [&](const ChangedFile* with) {
    Diagnostics found;
    const auto machine = import({folder, root, files, path}, with, found);
    if (machine) found.append(mission::validate(machine->mission));
    return found;
  };
  const Diagnostics before = errors(nullptr);
  Diagnostics added;
  const Diagnostics after = errors(&changed);
  for (const Diagnostic& item : after.items()) {
    const bool is_new = std::ranges::none_of(before.items(), [&](const Diagnostic& known) {
      return known.code == item.code && known.message == item.message;
    });
    if (is_new && item.severity == Severity::Error) added.add(item);
  }
  return added;
}

}  // namespace segue::web
