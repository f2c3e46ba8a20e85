// SPDX-License-Identifier: Apache-2.0
#include <segue/web/mission_files.hpp>

#include <segue/base/text.hpp>
#include <segue/mission/mission_io.hpp>

#include <utility>
#include <vector>

namespace segue::web {

namespace {

namespace fs = std::filesystem;
using type::Value;

Value to_value(const std::vector<mission::Port>& ports) {
  Value::List list;
  for (const mission::Port& port : ports)
    list.push_back(Value::map({{"name", port.name}, {"type", port.type}, {"default", port.value}}));
  return list;
}

/// "tools/grasp" of missions/tools/grasp.yaml for missions/fetch.yaml; empty: it cannot be named.
std::string library_name(const std::string& file, const std::string& user) {
  const auto slash = user.rfind('/');
  const std::string folder = slash == std::string::npos ? "" : user.substr(0, slash + 1);
  constexpr std::string_view kEnding = ".yaml";
  if (file == user || !file.starts_with(folder) || !file.ends_with(kEnding)) return "";
  return file.substr(folder.size(), file.size() - folder.size() - kEnding.size());
}

}  // namespace

mission::MayUse within(const FileFolder& folder, const fs::path& root) {
  return [&folder, root](const fs::path& file) {
    return folder.stat(file.lexically_normal().lexically_relative(root).generic_string()).has_value();
  };
}

Diagnostics check_mission(const fs::path& file, const std::string& text, const mission::MayUse& may_use) {
  Diagnostics all;
  (void)mission::load_mission_text(text, file, {}, all, may_use);
  Diagnostics found;
  for (const Diagnostic& item : all.items()) {
    if (item.where.file == file.string() || item.where.file.empty()) {
      found.add(item);
    } else if (item.severity == Severity::Error) {
      const std::string place =
          fs::path(item.where.file).lexically_relative(file.parent_path()).generic_string();
      found.error(item.code, place + ":" + std::to_string(item.where.line) + ": " + item.message,
                  {file.string(), 0, 0});
    }
  }
  return found;
}

Value libraries_for(const FileFolder& folder, const RobotFiles& files, const std::string& path) {
  Value::List list;
  for (const RobotFile& file : files.files) {
    const std::string name = file.kind == RobotFileKind::Mission ? library_name(file.path, path) : "";
    if (name.empty()) continue;
    const auto content = folder.read(file.path);
    Diagnostics ignored;
    const auto mission =
        content ? mission::read_mission(content->text, file.place.string(), ignored) : std::nullopt;
    if (!mission || mission->states.empty()) continue;
    const mission::State& root = mission->states.front();
    Value::List outcomes(root.outcomes.begin(), root.outcomes.end());
    list.push_back(Value::map({{"name", name},
                               {"path", file.path},
                               {"description", root.description},
                               {"inputs", to_value(root.inputs)},
                               {"outputs", to_value(root.outputs)},
                               {"outcomes", std::move(outcomes)}}));
  }
  return list;
}

}  // namespace segue::web
