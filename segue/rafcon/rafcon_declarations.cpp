// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/mission_file_parts.hpp>
#include <segue/rafcon/rafcon_state.hpp>
#include <segue/type/yaml.hpp>

#include <filesystem>
#include <utility>

namespace segue::mission::detail {

namespace {

using type::Value;

/// RAFCON's editor knows only texts and maps in semantic data: a text is taken as the YAML that it is, but
/// for facts, whose sign is not a tag, and for the values of inputs, which are not maps. A map without
/// entries is how the editor leaves an entry without a value.
Value from_texts(const Value& given) {
  if (given.is_string() && (given.as_string().starts_with('!') || parameter_input(given))) return given;
  if (given.is_string()) return type::parse_yaml(given.as_string()).value_or(given);
  if (!given.is_map()) return given;
  type::ValueMap result;
  for (const auto& [key, value] : given.as_map()) {
    if (!value.is_map() || !value.as_map().empty()) result.append(key, from_texts(value));
  }
  return result;
}

/// One fact is a list of one.
void list_facts(Value& declarations) {
  for (const char* key : {"preconditions", "effects", "world"}) {
    Value* facts = declarations.as_map().find(key);
    if (facts != nullptr && facts->is_string()) *facts = Value::List{*facts};
  }
}

/// Calls read(fields, source) with what the state declares for Segue, if it does.
template <class Read>
void with_declarations(const RafconState& state, Diagnostics& diagnostics, Read&& read) {
  const Value* given = state.notes.find("segue");
  if (given == nullptr || !given->is_map()) return;
  const auto file = std::filesystem::path(state.where.file).parent_path() / "semantic_data.json";
  const Source source(file.string(), diagnostics);
  Value declarations = from_texts(*given);
  list_facts(declarations);
  Fields fields(declarations, "'segue' in the semantic data of " + quote(state.name), source);
  read(fields, source);
  fields.finish();
}

}  // namespace

void declare(Action& action, const RafconState& state, Diagnostics& diagnostics) {
  with_declarations(state, diagnostics, [&](Fields& fields, const Source& source) {
    read_declarations(action, fields, source);
    const Value* isolated = fields.find("isolated");
    if (auto* script = std::get_if<Script>(&action.run); script != nullptr)
      script->isolated = fields.boolean("isolated", false);
    else if (isolated != nullptr)
      source.error("bad-script", fields.what() + ": only a script can be 'isolated'", *isolated);
    if (fields.find("run") != nullptr) action.run = read_run(fields, source);
  });
}

void declare(State& container, const RafconState& state, Diagnostics& diagnostics) {
  with_declarations(state, diagnostics, [&](Fields& fields, const Source& source) {
    container.strict = fields.boolean("strict", container.strict);
    container.routine = fields.boolean("routine", container.routine);
    read_needs(container.preconditions, container.resources, fields, source);
  });
}

void declare_library(State& library, const RafconState& state, Diagnostics& diagnostics) {
  with_declarations(state, diagnostics, [&](Fields& fields, const Source& source) {
    library.strict = fields.boolean("strict", library.strict);
    library.routine = fields.boolean("routine", library.routine);
    const bool root = state.kind != StateKind::Library;
    if (root) fields.ignore("world");
    const Value* resources = fields.find("resources");
    for (const Value* needs : {fields.find("preconditions"), resources}) {
      if (needs == nullptr || (root && needs == resources && needs->is_map())) continue;
      source.error("unsupported",
                   fields.what() +
                       ": a library cannot declare preconditions and resources; declare them of "
                       "its states, or of a state around it",
                   *needs);
    }
  });
}

void declare(Mission& mission, const RafconState& root, Diagnostics& diagnostics) {
  with_declarations(root, diagnostics, [&](Fields& fields, const Source& source) {
    mission.world = read_world(fields, source);
    if (const Value* resources = fields.find("resources", Value::Kind::Map)) {
      for (const auto& [name, value] : resources->as_map())
        mission.resources.push_back(read_resource(name, value, source));
    }
  });
}

}  // namespace segue::mission::detail
