// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/rafcon/semantic_data.hpp>
#include <segue/type/json.hpp>
#include <segue/web/files_verbs.hpp>
#include <segue/web/machine_files.hpp>

#include <utility>
#include <vector>

namespace segue::web {

namespace {

using type::Value;

/// The edits of semantic data in a command.
Result<std::vector<mission::SemanticEdit>> edits_of(const Command& command) {
  const Error wrong = fail(ErrorCode::InvalidArgument,
                           R"('edits' must be a list of {"keys": [texts], "value": the new value, if any})");
  const Value* list = command.arguments().find("edits");
  if (list == nullptr || !list->is_list()) return wrong;
  std::vector<mission::SemanticEdit> edits;
  for (const Value& item : list->as_list()) {
    const Value* keys = item.find("keys");
    if (keys == nullptr || !keys->is_list()) return wrong;
    mission::SemanticEdit edit;
    for (const Value& key : keys->as_list()) {
      if (!key.is_string()) return wrong;
      edit.keys.push_back(key.as_string());
    }
    if (const Value* value = item.find("value")) edit.value = *value;
    edits.push_back(std::move(edit));
  }
  return edits;
}

}  // namespace

/// The semantic data of a state; without a file, the text and its version are empty.
struct FileVerbs::SemanticData {
  std::filesystem::path robot;
  FileFolder folder;
  std::string machine;
  std::string path;
  FileFolder::Content content;

  [[nodiscard]] Diagnostics errors_with(const std::string& text) const {
    return errors_by_change(folder, robot.parent_path(), files_of(robot), machine, {path, text});
  }
};

Result<FileVerbs::SemanticData> FileVerbs::semantic_data_of(const Command& command) {
  const auto path = command.text("path");
  if (!path) return path.error();
  const auto state = command.text("state");
  if (!state) return state.error();
  const auto robot = robot_file();
  if (!robot) return robot.error();
  const auto file = find_file(*robot, *path);
  if (!file) return file.error();
  if (file->kind != RobotFileKind::Machine)
    return fail(ErrorCode::Unsupported, quote(*path) + " is not a state machine of RAFCON");
  auto folder = FileFolder::open(robot->parent_path());
  if (!folder) return folder.error();
  const std::string place = *path + "/" + (state->empty() ? "" : *state + "/");
  if (const auto is_state = folder->stat(place + "core_data.json"); !is_state) return is_state.error();
  const std::string name = place + "semantic_data.json";
  auto content = folder->read(name);
  if (!content && content.error().code == ErrorCode::NotFound) content = FileFolder::Content{};
  if (!content) return content.error();
  return SemanticData{*robot, std::move(*folder), *path, name, std::move(*content)};
}

Result<std::pair<FileVerbs::SemanticData, std::string>> FileVerbs::edited(const Command& command) {
  const auto version = command.text("version");
  if (!version) return version.error();
  const auto edits = edits_of(command);
  if (!edits) return edits.error();
  auto data = semantic_data_of(command);
  if (!data) return data.error();
  if (data->content.version != *version)
    return fail(ErrorCode::InvalidState,
                quote(data->path) + " was changed by somebody else meanwhile; nothing was changed");
  auto text = mission::edit_semantic_data(data->content.text, *edits);
  if (!text) return text.error();
  return std::pair(std::move(*data), std::move(*text));
}

Result<Value> FileVerbs::semantic_data(const Command& command) {
  const auto data = semantic_data_of(command);
  if (!data) return data.error();
  const std::string& text = data->content.text;
  auto value = text.empty() ? Result<Value>(type::ValueMap{}) : type::parse_json(text, data->path);
  if (!value) return value.error();
  return Value::map({{"data", std::move(*value)}, {"version", data->content.version}});
}

Result<Value> FileVerbs::check_semantic_data(const Command& command) {
  const auto changed = edited(command);
  if (!changed) return changed.error();
  return to_problems(changed->first.errors_with(changed->second));
}

Result<Value> FileVerbs::save_semantic_data(const Command& command) {
  const Lock lock(saving_);
  const auto changed = edited(command);
  if (!changed) return changed.error();
  const auto& [data, text] = *changed;
  if (text == data.content.text) return Value::map({{"version", data.content.version}});
  if (const Diagnostics errors = data.errors_with(text); errors.has_errors()) return errors.to_error();
  const auto version = data.content.version.empty()
                           ? data.folder.create(data.path, text)
                           : data.folder.replace(data.path, text, data.content.version);
  if (!version) return version.error();
  return Value::map({{"version", *version}});
}

}  // namespace segue::web
