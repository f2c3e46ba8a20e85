// SPDX-License-Identifier: Apache-2.0
#include <segue/web/mission_starts.hpp>

#include <segue/base/text.hpp>
#include <segue/control/verbs.hpp>
#include <segue/mission/controllers.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/type/yaml.hpp>
#include <segue/web/mission_files.hpp>

#include <algorithm>
#include <array>
#include <chrono>

namespace segue::web {

namespace {

using mission::Mission;
using type::Value;

constexpr Duration kStartTime = std::chrono::seconds(60);
constexpr std::array<std::string_view, 3> kModeNames = {"sequential", "concurrent", "strict"};

/// A mission of the robot that can be started.
struct Startable {
  std::filesystem::path file;
  Mission mission;
  [[nodiscard]] const mission::State& root() const { return mission.states.front(); }
};

Result<Startable> load(FileVerbs& files, const Command& command) {
  const auto path = command.text("path");
  if (!path) return path.error();
  const auto found = files.find(*path);
  if (!found) return found.error();
  const auto& [file, folder, root] = *found;
  if (file.kind != RobotFileKind::Mission)
    return fail(ErrorCode::InvalidArgument, quote(*path) + " is not a mission that can be started here");
  const auto content = folder.read(file.path);
  if (!content) return content.error();
  Diagnostics problems;
  auto mission = mission::load_mission_text(content->text, file.place, {}, problems, within(folder, root));
  if (!mission || mission->states.empty()) return problems.to_error();
  return Startable{file.place, std::move(*mission)};
}

/// The value that a person has written for an input.
Result<Value> value_of(const mission::Port& input, const std::string& text) {
  auto value = input.type == "text" ? Result<Value>(Value(text)) : type::parse_yaml(text);
  if (!value) return fail(ErrorCode::ParseError, "this is not YAML: " + value.error().message);
  if (mission::accepts(input.type, *value)) return value;
  return fail(ErrorCode::TypeMismatch,
              "this input is of type " + input.type + ", not " + type::describe(*value));
}

struct Inputs {
  type::ValueMap values;
  type::ValueMap problems;
};

Result<Inputs> inputs_of(const Command& command, const mission::State& root) {
  Inputs inputs;
  const Value* given = command.arguments().find("inputs");
  if (given == nullptr) return inputs;
  if (!given->is_map()) return fail(ErrorCode::InvalidArgument, "'inputs' must be a map of texts");
  for (const auto& [name, text] : given->as_map()) {
    if (!text.is_string()) return fail(ErrorCode::InvalidArgument, "'inputs' must be a map of texts");
    const auto input = std::ranges::find(root.inputs, name, &mission::Port::name);
    if (input == root.inputs.end() || input->from_world) {
      inputs.problems.set(name, "the mission has no such input");
      continue;
    }
    auto value = value_of(*input, text.as_string());
    if (value) {
      inputs.values.set(name, std::move(*value));
    } else {
      inputs.problems.set(name, value.error().message);
    }
  }
  return inputs;
}

/// Whoever may operate the robot may write missions, too.
Result<void> may_start(const Mission& mission, const PageUser& user) {
  const Role needed = control::role_for(control::Verb::RunScripts);
  if (user.role >= needed || !mission::has_scripts(mission)) return {};
  return fail(ErrorCode::PermissionDenied,
              "this browser may only " + std::string(to_string(user.role)) +
                  "; the mission has Python, which runs as the user of the studio: that needs the role " +
                  std::string(to_string(needed)));
}

}  // namespace

std::optional<MissionMode> mission_mode_named(std::string_view name) {
  const auto* found = std::ranges::find(kModeNames, name);
  if (found == kModeNames.end()) return std::nullopt;
  return static_cast<MissionMode>(found - kModeNames.begin());
}

Result<Value> MissionStarts::form(const Command& command, const PageUser& /*user*/) {
  const auto startable = load(files_, command);
  if (!startable) return startable.error();
  Value::List inputs;
  for (const mission::Port& port : startable->root().inputs) {
    if (port.from_world) continue;
    inputs.push_back(Value::map({{"name", port.name}, {"type", port.type}, {"default", port.value}}));
  }
  return Value::map({{"mission", startable->mission.name},
                     {"description", startable->root().description},
                     {"inputs", std::move(inputs)},
                     {"needs_robot", mission::needs_robot(startable->mission)}});
}

Result<Value> MissionStarts::start(const Command& command, const PageUser& user) {
  if (!run_) return fail(ErrorCode::Unsupported, "this studio starts no missions");
  MissionOrder order;
  const auto mode = command.text_or("mode", "sequential");
  if (!mode) return mode.error();
  const auto named = mission_mode_named(*mode);
  if (!named)
    return fail(ErrorCode::InvalidArgument, "'mode' must be 'sequential', 'concurrent' or 'strict'");
  for (const auto& [name, flag] :
       {std::pair("simulate", &MissionOrder::simulate), std::pair("steps_back", &MissionOrder::steps_back)}) {
    const auto given = command.flag(name);
    if (!given) return given.error();
    order.*flag = *given;
  }
  const auto deadline = command.deadline(kStartTime);
  if (!deadline) return deadline.error();
  const auto startable = load(files_, command);
  if (!startable) return startable.error();
  if (auto allowed = may_start(startable->mission, user); !allowed) return allowed.error();
  auto inputs = inputs_of(command, startable->root());
  if (!inputs) return inputs.error();
  if (!inputs->problems.empty()) return Value::map({{"problems", std::move(inputs->problems)}});
  order.file = startable->file;
  order.inputs = std::move(inputs->values);
  order.mode = *named;
  order.who = user.who;
  auto run = run_(order, *deadline);
  return run ? Result<Value>(Value::map({{"run", std::move(*run)}})) : Result<Value>(run.error());
}

}  // namespace segue::web
