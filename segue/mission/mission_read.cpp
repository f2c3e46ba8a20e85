// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/mission_file_parts.hpp>
#include <segue/mission/mission_io.hpp>

#include <algorithm>

namespace segue::mission {

using detail::Fields;
using detail::Source;
using type::Value;

namespace {

constexpr std::string_view kArrow = " -> ";
constexpr std::string_view kReturn = "return ";

class Reader {
 public:
  explicit Reader(const Source& source) : source_(source) {}

  Mission read(const Value& root) {
    Fields fields(root, "the mission", source_);
    mission_.file = source_.file();
    mission_.name = fields.required_name("mission", "give it a name");
    mission_.globals = detail::read_ports(fields, "globals", source_);
    mission_.vocabulary = detail::read_vocabulary(fields, source_);
    mission_.world = detail::read_world(fields, source_);
    mission_.world_data = detail::read_declared_data(fields, source_);
    mission_.observed = detail::read_observed(fields, source_);
    read_named(fields, "resources", [&](const std::string& name, const Value& value) {
      mission_.resources.push_back(detail::read_resource(name, value, source_));
    });
    read_named(fields, "actions", [&](const std::string& name, const Value& value) {
      mission_.actions.push_back(detail::read_action(name, value, source_));
    });
    constexpr std::array<std::string_view, 2> kAtEnd = {"halt", "keep"};
    mission_.at_end = static_cast<Mission::AtEnd>(fields.choice("at_end", kAtEnd, "bad-at-end").value_or(0));
    fields.ignore("libraries");
    State state;
    state.id = StateId(mission_.name);
    read_state(std::move(state), kNoState, root, fields);
    read_named(fields, "libraries", [&](const std::string& name, const Value& value) {
      check_library(name, value);
      const StateIndex library = read_state(named_state(name, value), kNoState, value);
      mission_.libraries.push_back({name, library, source_.at(value)});
    });
    return std::move(mission_);
  }

 private:
  template <class Read>
  void read_named(Fields& fields, std::string_view key, Read read) {
    const Value* map = fields.find(key, Value::Kind::Map);
    if (map == nullptr) return;
    for (const auto& [name, value] : map->as_map())
      read(name, value);
  }

  State named_state(const std::string& name, const Value& value) {
    State state;
    state.id = StateId(name);
    state.where = source_.at(value);
    return state;
  }

  /// "folder/name" may only consist of identifiers, so that no name leads out of the folders of libraries.
  void check_library(const std::string& name, const Value& at) {
    for (std::string_view rest = name;;) {
      const auto slash = rest.find('/');
      if (!is_identifier(rest.substr(0, slash))) {
        source_.error("bad-name",
                      "library " + quote(name) + ": expected names joined by '/', such as 'tools/grasp'", at);
        return;
      }
      if (slash == std::string_view::npos) return;
      rest.remove_prefix(slash + 1);
    }
  }

  StateIndex read_state(State state, StateIndex parent, const Value& value) {
    Fields fields(value, parent == kNoState ? "library " + quote(state.id.str()) : described(state), source_);
    const StateIndex index = read_state(std::move(state), parent, value, fields);
    return index;
  }

  static std::string described(const State& state) { return "state " + quote(state.id.str()); }

  /// Reads the fields of a state. Fields of the mission itself must have been read before.
  StateIndex read_state(State state, StateIndex parent, const Value& value, Fields& fields) {
    state.where = source_.at(value);
    state.title = fields.text("title");
    state.script_id = fields.text("id");
    state.description = fields.text("description");
    const bool container = fields.find("states", Value::Kind::Map) != nullptr;
    const bool root = parent == kNoState;
    state.kind = kind_of(fields, container);
    state.strict = fields.boolean("strict", false);
    if (!is_leaf(state.kind)) state.routine = fields.boolean("routine", false);
    if (const Value* notes = fields.find("notes", Value::Kind::Map)) state.notes = *notes;
    read_transitions(state, fields);
    if (is_container(state.kind)) {
      read_container(state, fields);
      if (!root) detail::read_needs(state.preconditions, state.resources, fields, source_);
    } else {
      read_use(state, fields);
    }
    const Value* states = is_container(state.kind) ? fields.find("states", Value::Kind::Map) : nullptr;
    const StateIndex index = mission_.add(parent, std::move(state));
    fields.finish();
    if (states == nullptr) return index;
    for (const auto& [id, child] : states->as_map()) {
      check_id(id, child);
      read_state(named_state(id, child), index, child);
    }
    return index;
  }

  StateKind kind_of(Fields& fields, bool container) {
    const bool library = fields.find("library") != nullptr;
    const auto kind = fields.choice("kind", kStateKindNames, "bad-kind");
    if (!kind) return container ? StateKind::Hierarchy : library ? StateKind::Library : StateKind::Execution;
    const auto chosen = static_cast<StateKind>(*kind);
    if ((container && !is_container(chosen)) || (library && chosen != StateKind::Library)) {
      source_.error("bad-kind",
                    fields.what() + ": what has " + (container ? "'states'" : "'library'") +
                        " cannot be of kind " + quote(kStateKindNames[*kind]),
                    *fields.find("kind"));
    }
    return chosen;
  }

  void check_id(const std::string& id, const Value& at) {
    if (!model::detail::check_name(id, "a state", at, source_)) return;
    const bool reserved = id == "inputs" || id == "outputs" || id == "variables";
    if (reserved || id.find('.') != std::string::npos) {
      source_.error("bad-name",
                    "no state can be called " + quote(id) + ": " +
                        (reserved ? "in data flows this means the ports of the parent state"
                                  : "in data flows '.' ends the name"),
                    at);
    }
  }

  void read_use(State& state, Fields& fields) {
    if (state.kind == StateKind::Library) {
      if (const Value* library = fields.require("library", "name the state machine to use")) {
        state.library = fields.text("library");
        check_library(state.library, *library);
      }
    } else {
      const std::string action = fields.name("action");
      state.action = ActionName(action.empty() ? state.id.str() : action);
    }
    state.input_values = detail::read_values(fields, "inputs", source_);
    state.output_values = detail::read_values(fields, "outputs", source_);
  }

  void read_container(State& state, Fields& fields) {
    state.inputs = detail::read_ports(fields, "inputs", source_);
    state.outputs = detail::read_ports(fields, "outputs", source_);
    state.outcomes = detail::read_outcomes(fields, source_);
    state.variables = detail::read_ports(fields, "variables", source_);
    if (state.kind == StateKind::Hierarchy) {
      if (const Value* start = fields.find("start"))
        state.start = read_target(*start, fields.what() + ": 'start'");
    }
    const Value* flows = fields.find("flows", Value::Kind::List);
    if (flows == nullptr) return;
    for (const Value& item : flows->as_list())
      read_flow(state, item, fields.what());
  }

  std::optional<Target> read_target(const Value& value, const std::string& what) {
    const auto text = model::detail::scalar_text(value);
    if (!text || text->empty()) {
      source_.error(
          "bad-target",
          what + " must name a state, or an outcome as in 'return success', got " + type::describe(value),
          value);
      return std::nullopt;
    }
    if (text->starts_with(kReturn)) return Target{StateId(), text->substr(kReturn.size())};
    if (!model::detail::check_name(*text, what, value, source_)) return std::nullopt;
    return Target{StateId(*text), {}};
  }

  void read_transitions(State& state, Fields& fields) {
    const Value* map = fields.find("on", Value::Kind::Map);
    if (map == nullptr) return;
    for (const auto& [outcome, to] : map->as_map()) {
      detail::check_free_name(outcome, fields.what() + ": 'on'", to, source_);
      if (auto target = read_target(to, fields.what() + ": the transition from " + quote(outcome)))
        state.transitions.push_back({outcome, std::move(*target), source_.at(to)});
    }
  }

  void read_flow(State& state, const Value& item, const std::string& what) {
    std::string from;
    std::string to;
    if (item.is_map()) {
      Fields fields(item, "a data flow of " + what, source_);
      fields.require("from");
      fields.require("to");
      from = fields.text("from");
      to = fields.text("to");
      fields.finish();
    } else {
      const std::string text = model::detail::scalar_text(item).value_or("");
      const auto arrow = text.find(kArrow);
      if (arrow != std::string::npos) {
        from = text.substr(0, arrow);
        to = text.substr(arrow + kArrow.size());
      }
    }
    auto source = read_port_ref(from);
    auto target = read_port_ref(to);
    if (source && target) {
      state.flows.push_back({std::move(*source), std::move(*target), source_.at(item)});
      return;
    }
    source_.error(
        "bad-flow",
        what + ": 'flows' must be such as 'look.pose -> grasp.pose' or 'inputs.box -> look.box', got " +
            type::describe(item),
        item);
  }

  static std::optional<FlowPort> read_port_ref(const std::string& text) {
    const auto dot = text.find('.');
    if (dot == std::string::npos || dot + 1 == text.size()) return std::nullopt;
    const std::string owner = text.substr(0, dot);
    FlowPort ref;
    ref.port = text.substr(dot + 1);
    if (owner == "inputs") {
      ref.owner = Owner::Inputs;
    } else if (owner == "outputs") {
      ref.owner = Owner::Outputs;
    } else if (owner == "variables") {
      ref.owner = Owner::Variables;
    } else if (is_identifier(owner)) {
      ref.state = StateId(owner);
    } else {
      return std::nullopt;
    }
    return ref;
  }

  const Source& source_;
  Mission mission_;
};

}  // namespace

std::optional<Mission> read_mission(std::string_view text, const std::string& file,
                                    Diagnostics& diagnostics) {
  const Source source(file, diagnostics);
  const std::size_t errors_before = diagnostics.error_count();
  const auto root = source.parse(text);
  if (!root) return std::nullopt;
  Mission mission = Reader(source).read(*root);
  if (diagnostics.error_count() > errors_before) return std::nullopt;
  return mission;
}

}  // namespace segue::mission
