// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/model/reader.hpp>

#include <algorithm>
#include <map>
#include <unordered_set>
#include <utility>

namespace segue::mission {
namespace {

using std::filesystem::path;

/// Files are relative to that of the mission, so the same name in two folders is two scripts.
bool scripts_are_one(const Action& a, const Action& b) {
  const auto* script = std::get_if<Script>(&a.run);
  return script == nullptr || script->file.empty() ||
         path(a.where.file).parent_path() == path(b.where.file).parent_path();
}

/// Adds the state machines of other files to a mission.
class Collector {
 public:
  Collector(Mission& mission, const std::vector<path>& folders, Diagnostics& diagnostics,
            const MayUse& may_use)
      : mission_(mission), folders_(folders), diagnostics_(diagnostics), may_use_(may_use) {}

  void run() {
    for (const Library& library : mission_.libraries)
      known_.insert(library.name);
    // The list grows: the states of a library may use further libraries.
    for (StateIndex index = 0; index < mission_.states.size(); ++index) {
      const State& state = mission_.states[index];
      if (state.kind == StateKind::Library && known_.insert(state.library).second)
        add(state.library, state.where);
    }
  }

 private:
  /// By value: what the arguments come from may move while libraries are added.
  // NOLINTNEXTLINE(performance-unnecessary-value-param)
  void add(const std::string name, const SourcePlace user) {
    const path file = find(name, path(user.file.empty() ? mission_.file : user.file).parent_path());
    if (file.empty()) return;
    const auto text = model::detail::read_text(file, diagnostics_);
    if (!text) return;
    if (auto library = read_mission(*text, file.string(), diagnostics_)) take(name, std::move(*library));
  }

  [[nodiscard]] path find(const std::string& name, const path& beside) const {
    std::vector<path> folders = {beside};
    folders.insert(folders.end(), folders_.begin(), folders_.end());
    for (const path& folder : folders) {
      path file = folder / (name + ".yaml");
      std::error_code ignored;
      if (std::filesystem::is_regular_file(file, ignored) && (!may_use_ || may_use_(file))) return file;
    }
    return {};
  }

  void take(const std::string& name, Mission library) {
    take_actions(name, library);
    take_shared(mission_.globals, library.globals, "global variable");
    take_shared(mission_.resources, library.resources, "resource");
    take_shared(mission_.world_data, library.world_data, "world data");
    const auto offset = static_cast<StateIndex>(mission_.states.size());
    for (State& state : library.states) {
      if (state.parent != kNoState) state.parent += offset;
      for (StateIndex& child : state.children)
        child += offset;
      mission_.states.push_back(std::move(state));
    }
    mission_.libraries.push_back({name, offset, mission_.states[offset].where});
    for (Library& inner : library.libraries) {
      if (!known_.insert(inner.name).second) {
        diagnostics_.error("duplicate-library", "library " + quote(inner.name) + " is defined twice",
                           inner.where);
        continue;
      }
      inner.root += offset;
      mission_.libraries.push_back(std::move(inner));
    }
  }

  /// An action that differs from one of the same name gets the library's name as a prefix.
  void take_actions(const std::string& name, Mission& library) {
    std::string prefix = name;
    std::ranges::replace(prefix, '/', ':');
    std::map<ActionName, ActionName> renamed;
    for (Action& action : library.actions) {
      const auto same = std::ranges::find(mission_.actions, action.name, &Action::name);
      const bool taken = same != mission_.actions.end();
      if (taken && *same == action && scripts_are_one(*same, action)) continue;
      if (taken) {
        const ActionName fresh(prefix + ":" + action.name.str());
        renamed.emplace(action.name, fresh);
        action.name = fresh;
      }
      mission_.actions.push_back(std::move(action));
    }
    for (State& state : library.states) {
      if (const auto found = renamed.find(state.action); found != renamed.end()) state.action = found->second;
    }
  }

  template <class Item>
  void take_shared(std::vector<Item>& ours, std::vector<Item>& theirs, const std::string& what) {
    for (Item& item : theirs) {
      const auto same = std::ranges::find(ours, item.name, &Item::name);
      if (same == ours.end()) {
        ours.push_back(std::move(item));
      } else if (!(*same == item)) {
        diagnostics_.error(
            "conflicting-declaration",
            what + " " + quote(item.name) + " is declared differently at " + to_string(same->where),
            item.where);
      }
    }
  }

  Mission& mission_;
  const std::vector<path>& folders_;
  Diagnostics& diagnostics_;
  const MayUse& may_use_;
  std::unordered_set<std::string> known_;
};

}  // namespace

void add_libraries(Mission& mission, const std::vector<path>& folders, Diagnostics& diagnostics,
                   const MayUse& may_use) {
  Collector(mission, folders, diagnostics, may_use).run();
}

path script_file(const Mission& mission, const Action& action) {
  return script_file(mission, std::get<Script>(action.run), action.where);
}

path script_file(const Mission& mission, const Script& script, const SourcePlace& where) {
  const path origin = where.file.empty() ? mission.file : where.file;
  std::error_code ignored;
  const path folder = origin.empty() ? path() : std::filesystem::absolute(origin, ignored).parent_path();
  return (folder / script.file).lexically_normal();
}

namespace {

void check_scripts(const Mission& mission, Diagnostics& diagnostics, const MayUse& may_use) {
  const auto check = [&](const Script& script, const std::string& what, const SourcePlace& where) {
    std::error_code ignored;
    if (script.file.empty()) return;
    const path file = script_file(mission, script, where);
    if ((!may_use || may_use(file)) && std::filesystem::is_regular_file(file, ignored)) return;
    diagnostics.warning("missing-script", what + ": there is no script " + quote(script.file), where);
  };
  for (const Action& action : mission.actions) {
    const auto* script = std::get_if<Script>(&action.run);
    if (script != nullptr) check(*script, "action " + quote(action.name.str()), action.where);
  }
  for (const DeclaredData& data : mission.world_data)
    check(data.functions, "the world data " + quote(data.name), data.where);
}

}  // namespace

std::optional<Mission> load_mission_text(std::string_view text, const path& file,
                                         const std::vector<path>& library_folders, Diagnostics& diagnostics,
                                         const MayUse& may_use) {
  const std::size_t errors_before = diagnostics.error_count();
  auto mission = read_mission(text, file.string(), diagnostics);
  if (!mission) return std::nullopt;
  add_libraries(*mission, library_folders, diagnostics, may_use);
  diagnostics.append(validate(*mission));
  check_scripts(*mission, diagnostics, may_use);
  if (diagnostics.error_count() > errors_before) return std::nullopt;
  return mission;
}

std::optional<Mission> load_mission(const path& file, const std::vector<path>& library_folders,
                                    Diagnostics& diagnostics) {
  const auto text = model::detail::read_text(file, diagnostics);
  return text ? load_mission_text(*text, file, library_folders, diagnostics) : std::nullopt;
}

}  // namespace segue::mission
