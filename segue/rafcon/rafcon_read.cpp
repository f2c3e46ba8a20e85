// SPDX-License-Identifier: Apache-2.0
#include <segue/base/input_file.hpp>
#include <segue/base/text.hpp>
#include <segue/model/reader.hpp>
#include <segue/rafcon/rafcon_state.hpp>
#include <segue/type/json.hpp>

#include <algorithm>
#include <charconv>

namespace segue::mission {
namespace detail {
namespace {

using model::detail::Fields;
using model::detail::Source;
using type::Value;
using type::ValueMap;

/// The kind is the last part of "rafcon.core.states.hierarchy_state.HierarchyState", in old files of
/// "rafcon.statemachine...".
std::optional<StateKind> kind_of(std::string_view qualified) {
  constexpr std::pair<std::string_view, StateKind> kKinds[] = {
      {"ExecutionState", StateKind::Execution},
      {"HierarchyState", StateKind::Hierarchy},
      {"BarrierConcurrencyState", StateKind::Barrier},
      {"PreemptiveConcurrencyState", StateKind::Preemptive},
      {"LibraryState", StateKind::Library},
      {"DeciderState", StateKind::Decider}};
  const std::string_view name = qualified.substr(qualified.rfind('.') + 1);
  for (const auto& [known, kind] : kKinds) {
    if (name == known) return kind;
  }
  return std::nullopt;
}

/// Maps {"__type__": "__builtin__.int"} or "int" to the names of missions; keeps other types.
std::string type_name(const Value& value) {
  const Value* wrapped = value.find("__type__");
  const Value& named = wrapped == nullptr ? value : *wrapped;
  if (!named.is_string()) return "any";
  std::string_view name = named.as_string();
  for (const std::string_view module : {"__builtin__.", "builtins."}) {
    if (name.starts_with(module)) name.remove_prefix(module.size());
  }
  constexpr std::pair<std::string_view, std::string_view> kTypes[] = {
      {"str", "text"}, {"unicode", "text"}, {"dict", "map"},
      {"long", "int"}, {"NoneType", "any"}, {"object", "any"}};
  for (const auto& [python, ours] : kTypes) {
    if (name == python) return std::string(ours);
  }
  return std::string(name);
}

/// Turns tuples into lists and types into their names. The parser limits the nesting.
Value plain(const Value& value) {
  if (value.is_list()) {
    Value::List list;
    for (const Value& item : value.as_list())
      list.push_back(plain(item));
    return list;
  }
  if (!value.is_map()) return value;
  if (const Value* items = value.find("items");
      items != nullptr && value.find("__jsonqualname__") != nullptr) {
    return plain(*items);
  }
  if (value.find("__type__") != nullptr) return type_name(value);
  ValueMap map;
  for (const auto& [key, entry] : value.as_map())
    map.append(key, plain(entry));
  return map;
}

class Reader {
 public:
  Reader(const Value& root, const Source& source) : source_(source), fields_(root, "the state", source) {}

  std::unique_ptr<RafconState> read() {
    auto state = std::make_unique<RafconState>();
    state->where = source_.at(fields_.value());
    fields_.require("__jsonqualname__");
    const auto kind = kind_of(fields_.text("__jsonqualname__"));
    if (!kind) source_.error("bad-kind", "this is not a kind of state that RAFCON has", fields_.value());
    state->kind = kind.value_or(StateKind::Execution);
    fields_.require("state_id");
    state->id = fields_.text("state_id");
    state->name = fields_.text("name");
    state->description = fields_.text("description");
    read_outcomes(*state);
    state->inputs = read_ports("input_data_ports");
    state->outputs = read_ports("output_data_ports");
    if (is_container(state->kind)) {
      state->variables = read_ports("scoped_variables");
      state->transitions = read_links("transitions", "from_outcome", "to_outcome");
      state->flows = read_links("data_flows", "from_key", "to_key");
    }
    if (state->kind == StateKind::Library) read_library(*state);
    return state;
  }

 private:
  static std::optional<std::int64_t> number(const Value& value) {
    if (value.kind() == Value::Kind::Int) return value.as_int();
    if (!value.is_string()) return std::nullopt;
    std::int64_t result = 0;
    const std::string& text = value.as_string();
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), result);
    if (status != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return result;
  }

  /// Reads the entries of a map whose keys are numbers.
  template <class Read>
  void each(std::string_view key, Read read) {
    const Value* map = fields_.find(key, Value::Kind::Map);
    if (map == nullptr) return;
    for (const auto& [name, value] : map->as_map()) {
      if (const auto id = number(Value(name))) {
        read(*id, value);
      } else if (!name.starts_with("__")) {
        source_.error("bad-id", quote(key) + ": expected numbers as keys, got " + quote(name), value);
      }
    }
  }

  void read_outcomes(RafconState& state) {
    each("outcomes", [&](std::int64_t id, const Value& value) {
      Fields outcome(value, "an outcome", source_);
      state.outcomes[id] = outcome.text("name");
    });
    state.outcomes[kAbortedId] = kAbortedName;
    state.outcomes[kPreemptedId] = kPreemptedName;
  }

  RafconPorts read_ports(std::string_view key) {
    RafconPorts ports;
    each(key, [&](std::int64_t id, const Value& value) {
      Fields fields(value, "a data port", source_);
      RafconPort port;
      fields.require("name");
      port.name = fields.text("name");
      const Value* type = fields.find("data_type");
      port.type = type == nullptr ? "any" : type_name(*type);
      if (const Value* given = fields.find("default_value")) port.value = plain(*given);
      ports[id] = std::move(port);
    });
    return ports;
  }

  std::vector<RafconLink> read_links(std::string_view key, std::string_view from, std::string_view to) {
    std::vector<RafconLink> links;
    each(key, [&](std::int64_t /*id*/, const Value& value) {
      Fields fields(value, std::string("an entry of ") + quote(key), source_);
      RafconLink link;
      link.where = source_.at(value);
      link.from_state = fields.text("from_state");
      link.to_state = fields.text("to_state");
      if (const Value* end = fields.find(from)) link.from = number(*end);
      if (const Value* end = fields.find(to)) link.to = number(*end);
      links.push_back(std::move(link));
    });
    return links;
  }

  void read_library(RafconState& state) {
    fields_.require("library_name");
    const std::string path = fields_.text("library_path");
    state.library = (path.empty() ? "" : path + "/") + fields_.text("library_name");
    read_values("use_runtime_value_input_data_ports", "input_data_port_runtime_values", state.input_values);
    read_values("use_runtime_value_output_data_ports", "output_data_port_runtime_values",
                state.output_values);
  }

  void read_values(std::string_view used, std::string_view key, std::map<std::int64_t, Value>& values) {
    std::map<std::int64_t, bool> wanted;
    each(used, [&](std::int64_t id, const Value& value) { wanted[id] = value.is_bool() && value.as_bool(); });
    each(key, [&](std::int64_t id, const Value& value) {
      if (wanted[id]) values[id] = plain(value);
    });
  }

  static constexpr std::int64_t kAbortedId = -1;
  static constexpr std::int64_t kPreemptedId = -2;
  const Source& source_;
  Fields fields_;
};

}  // namespace

std::unique_ptr<RafconState> read_core_data(std::string_view text, const std::string& file,
                                            Diagnostics& diagnostics) {
  const auto root = type::parse_json(text, file);
  if (!root) {
    diagnostics.error("parse-error", root.error().message, root.error().where);
    return nullptr;
  }
  const Source source(file, diagnostics);
  const std::size_t errors_before = diagnostics.error_count();
  auto state = Reader(*root, source).read();
  if (diagnostics.error_count() > errors_before) return nullptr;
  return state;
}

}  // namespace detail

namespace {

using detail::RafconState;
using std::filesystem::path;

/// Deeper than any path in a file system can be.
constexpr int kDeepest = 200;

class Loader {
 public:
  Loader(const std::vector<RafconLibraryPath>& paths, const ReadText& read, Diagnostics& diagnostics)
      : paths_(paths), read_(read), diagnostics_(diagnostics) {}

  detail::RafconFiles load(const path& folder) {
    files_.root = machine(folder);
    // Libraries may use further ones, so the list grows during the loop.
    for (std::size_t i = 0; i < wanted_.size(); ++i) {
      const auto [name, where] = wanted_[i];
      const auto [entry, fresh] = files_.libraries.try_emplace(name);
      if (!fresh) continue;
      const path found = find(name);
      if (found.empty()) {
        diagnostics_.error("missing-library",
                           "there is no library " + quote(name) + " in the library paths given", where);
      } else {
        entry->second = machine(found);
      }
    }
    return std::move(files_);
  }

 private:
  [[nodiscard]] path find(const std::string& name) const {
    const auto slash = name.find('/');
    for (const RafconLibraryPath& known : paths_) {
      if (!known.name.empty() && known.name != name.substr(0, slash)) continue;
      path folder = slash == std::string::npos ? known.folder : known.folder / name.substr(slash + 1);
      std::error_code ignored;
      if (std::filesystem::is_regular_file(folder / "statemachine.json", ignored)) return folder;
    }
    return {};
  }

  std::unique_ptr<RafconState> machine(const path& folder) {
    const auto text = text_of(folder / "statemachine.json");
    if (!text) return nullptr;
    const auto root = type::parse_json(*text, (folder / "statemachine.json").string());
    if (!root) {
      diagnostics_.error("parse-error", root.error().message, root.error().where);
      return nullptr;
    }
    std::error_code ignored;
    if (std::filesystem::is_regular_file(folder / "core_data.json", ignored)) return state(folder, 0);
    for (const std::string_view key : {"root_state_storage_id", "root_state_id"}) {
      const type::Value* name = root->find(key);
      if (name == nullptr || !name->is_string()) continue;
      // The name comes from a file: it must not lead out of the folder.
      const path inside = path(name->as_string()).filename();
      if (!inside.empty() && inside != "..") return state(folder / inside, 0);
    }
    diagnostics_.error("no-root", "statemachine.json names no root state", {folder.string(), 0, 0});
    return nullptr;
  }

  std::unique_ptr<RafconState> state(const path& folder, int depth) {
    const path file = folder / "core_data.json";
    const auto text = text_of(file);
    if (!text) return nullptr;
    auto state = detail::read_core_data(*text, file.string(), diagnostics_);
    if (!state) return nullptr;
    if (state->kind == StateKind::Library) wanted_.emplace_back(state->library, state->where);
    read_beside(*state, folder);
    if (is_container(state->kind) && depth < kDeepest) read_children(*state, folder, depth);
    return state;
  }

  void read_beside(RafconState& state, const path& folder) {
    std::error_code ignored;
    if (const path script = folder / "script.py"; std::filesystem::is_regular_file(script, ignored)) {
      state.script = text_of(script).value_or("");
    }
    const path notes = folder / "semantic_data.json";
    const auto text = read_text(notes);
    if (!text && text.error().code == ErrorCode::NotFound) return;
    if (!text) return diagnostics_.error("unreadable-file", text.error().message, {notes.string(), 0, 0});
    auto read = type::parse_json(*text, notes.string());
    if (!read) {
      diagnostics_.error("parse-error", read.error().message, read.error().where);
    } else if (read->is_map()) {
      state.notes = std::move(*read);
    }
  }

  void read_children(RafconState& around, const path& folder, int depth) {
    std::vector<path> folders;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
      if (entry.is_directory(error) &&
          std::filesystem::is_regular_file(entry.path() / "core_data.json", error))
        folders.push_back(entry.path());
    }
    std::ranges::sort(folders);
    for (const path& inner : folders) {
      if (auto child = state(inner, depth + 1)) around.children.push_back(std::move(child));
    }
  }

  Result<std::string> read_text(const path& file) { return read_ ? read_(file) : read_input_file(file); }

  std::optional<std::string> text_of(const path& file) {
    auto text = read_text(file);
    if (text) return std::move(*text);
    diagnostics_.error("unreadable-file", text.error().message, {file.string(), 0, 0});
    return std::nullopt;
  }

  const std::vector<RafconLibraryPath>& paths_;
  const ReadText& read_;
  Diagnostics& diagnostics_;
  detail::RafconFiles files_;
  std::vector<std::pair<std::string, SourceLocation>> wanted_;
};

}  // namespace

std::vector<RafconLibraryPath> rafcon_library_paths(const std::vector<std::string>& texts) {
  std::vector<RafconLibraryPath> paths;
  for (const std::string& text : texts) {
    const auto equals = text.find('=');
    if (equals == std::string::npos) {
      paths.push_back({path(text).filename().string(), text});
    } else {
      paths.push_back({text.substr(0, equals), text.substr(equals + 1)});
    }
  }
  return paths;
}

std::optional<RafconImport> import_rafcon(const path& folder, const std::vector<RafconLibraryPath>& libraries,
                                          Diagnostics& diagnostics, const ReadText& read) {
  const std::size_t errors_before = diagnostics.error_count();
  const detail::RafconFiles files = Loader(libraries, read, diagnostics).load(folder);
  if (diagnostics.error_count() > errors_before || !files.root) return std::nullopt;
  return detail::convert(files, diagnostics);
}

}  // namespace segue::mission
