// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/rafcon/rafcon_state.hpp>

#include <algorithm>
#include <filesystem>
#include <set>
#include <unordered_map>

namespace segue::mission::detail {
namespace {

using type::Value;

/// Counters saturate here: a machine can contain its libraries exponentially often.
constexpr std::uint64_t kMost = std::uint64_t{1} << 60;

/// Turns a name into an id of letters, digits, '_' and '-'. A name without any letter or digit of ASCII, as
/// in most alphabets, tells nothing then: the id is made of `otherwise`, which is RAFCON's id.
std::string identifier(const std::string& name, const std::string& otherwise = {}) {
  std::string id;
  bool tells = false;
  for (const char c : name) {
    const bool says = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    const bool continues = (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;  // a character of UTF-8
    tells = tells || says;
    if (!continues) id += says || c == '_' || c == '-' ? c : '_';
  }
  if (!tells && !otherwise.empty()) return identifier(otherwise);
  if (id.empty() || id.front() == '-') id.insert(0, "_");
  if (id == "inputs" || id == "outputs" || id == "variables") id += "_";
  return id.substr(0, 200);
}

/// The name, with a number appended if it is taken.
std::string unique(const std::string& name, std::set<std::string>& taken) {
  std::string candidate = name;
  for (int i = 2; !taken.insert(candidate).second; ++i)
    candidate = name + "_" + std::to_string(i);
  return candidate;
}

/// The names that the ports and outcomes of a state get in the mission, by RAFCON's numbers.
struct Names {
  std::map<std::int64_t, std::string> inputs;
  std::map<std::int64_t, std::string> outputs;
  std::map<std::int64_t, std::string> variables;
  std::map<std::int64_t, std::string> outcomes;
};

class Converter {
 public:
  Converter(const RafconFiles& files, Diagnostics& diagnostics) : files_(files), diagnostics_(diagnostics) {}

  std::optional<RafconImport> run() {
    const std::size_t errors_before = diagnostics_.error_count();
    name_libraries();
    mission_.name = identifier(files_.root->name, files_.root->id);
    add(*files_.root, kNoState, mission_.name);
    if (is_container(files_.root->kind)) declare(mission_, *files_.root, diagnostics_);
    mission_.states.front().title = files_.root->name == mission_.name ? "" : files_.root->name;
    for (const auto& [path, root] : files_.libraries) {
      const StateIndex index = add(*root, kNoState, library_names_[path]);
      mission_.libraries.push_back({library_names_[path], index, {}});
    }
    RafconImport result{{}, count(*files_.root)};
    if (diagnostics_.error_count() > errors_before) return std::nullopt;
    widen_types(mission_, diagnostics_);
    result.mission = std::move(mission_);
    return result;
  }

 private:
  void error(std::string code, const std::string& message, const SourceLocation& where) {
    diagnostics_.error(std::move(code), message, where);
  }

  void name_libraries() {
    std::set<std::string> taken;
    for (const auto& [path, root] : files_.libraries) {
      std::string name;
      for (std::size_t begin = 0; begin <= path.size();) {
        const auto slash = std::min(path.find('/', begin), path.size());
        name += (begin == 0 ? "" : "/") + identifier(path.substr(begin, slash - begin));
        begin = slash + 1;
      }
      library_names_[path] = unique(name, taken);
    }
  }

  static std::map<std::int64_t, std::string> names_of(const RafconPorts& ports) {
    std::map<std::int64_t, std::string> names;
    std::set<std::string> taken;
    for (const auto& [id, port] : ports)
      names[id] = unique(port.name.empty() ? "port" : port.name, taken);
    return names;
  }

  /// The state that declares the interface; for a library state, the root of its machine, transitively.
  const Names& names(const RafconState& state) {
    const RafconState* shown = &state;
    for (std::size_t steps = 0; shown->kind == StateKind::Library && steps <= files_.libraries.size();
         ++steps)
      shown = files_.libraries.at(shown->library).get();
    const auto [found, fresh] = names_.try_emplace(shown);
    if (!fresh) return found->second;
    Names& names = found->second;
    names.inputs = names_of(shown->inputs);
    names.outputs = names_of(shown->outputs);
    names.variables = names_of(shown->variables);
    std::set<std::string> taken = {std::string(kAbortedName), std::string(kPreemptedName)};
    for (const auto& [id, name] : shown->outcomes)
      names.outcomes[id] = id < 0 ? name : unique(name.empty() ? "outcome" : name, taken);
    return names;
  }

  static std::vector<Port> ports(const RafconPorts& ports, const std::map<std::int64_t, std::string>& names) {
    std::vector<Port> result;
    for (const auto& [id, port] : ports)
      result.push_back({names.at(id), port.type, port.value, {}});
    return result;
  }

  static std::vector<std::string> outcomes(const Names& names) {
    std::vector<std::string> result;
    for (const auto& [id, name] : names.outcomes) {
      if (id >= 0) result.push_back(name);
    }
    return result;
  }

  /// Converts the state and its descendants, parents first.
  StateIndex add(const RafconState& raw, StateIndex parent, const std::string& id) {
    State state;
    state.id = StateId(id);
    if (parent != kNoState && raw.name != id) state.title = raw.name;
    if (raw.id != id) state.script_id = raw.id;
    state.description = raw.description;
    state.kind = raw.kind;
    state.notes = raw.notes;
    state.where = raw.where;
    const Names& shown = names(raw);
    if (raw.kind == StateKind::Library) {
      state.library = library_names_.at(raw.library);
      give(state.input_values, raw.input_values, shown.inputs);
      give(state.output_values, raw.output_values, shown.outputs);
      declare_library(state, raw, diagnostics_);
    } else if (!is_container(raw.kind)) {
      state.action = add_action(raw, shown, id);
    } else {
      state.inputs = ports(raw.inputs, shown.inputs);
      state.outputs = ports(raw.outputs, shown.outputs);
      state.outcomes = outcomes(shown);
      state.variables = ports(raw.variables, shown.variables);
      if (parent != kNoState)
        declare(state, raw, diagnostics_);
      else if (&raw != files_.root.get())
        declare_library(state, raw, diagnostics_);
    }
    const StateIndex index = mission_.add(parent, std::move(state));
    if (is_container(raw.kind)) add_inside(raw, index);
    return index;
  }

  static void give(std::vector<PortValue>& values, const std::map<std::int64_t, Value>& given,
                   const std::map<std::int64_t, std::string>& names) {
    for (const auto& [id, value] : given) {
      if (const auto name = names.find(id); name != names.end()) values.push_back({name->second, value, {}});
    }
  }

  ActionName add_action(const RafconState& raw, const Names& shown, const std::string& id) {
    Action action;
    action.description = raw.description;
    action.inputs = ports(raw.inputs, shown.inputs);
    action.outputs = ports(raw.outputs, shown.outputs);
    action.outcomes = outcomes(shown);
    action.where = raw.where;
    if (!raw.script.empty()) {
      const auto file = std::filesystem::path(raw.where.file).parent_path() / "script.py";
      action.run = Script{{}, raw.script, false, SourceLocation{file.string(), 0, 0}};
    }
    declare(action, raw, diagnostics_);
    check_numbers(raw, shown);
    std::string name = id;
    std::ranges::replace(name, '/', ':');
    action.name = ActionName(unique(name, action_names_));
    mission_.actions.push_back(action);
    return action.name;
  }

  /// Missions number outcomes consecutively; in RAFCON numbers may be missing.
  void check_numbers(const RafconState& raw, const Names& shown) {
    std::int64_t next = 0;
    for (const auto& [id, name] : shown.outcomes) {
      if (id >= 0 && id != next++) {
        diagnostics_.warning("outcome-numbers",
                             "the outcomes of " + quote(raw.name) +
                                 " are not numbered 0, 1, 2 ...: its script must return them by name",
                             raw.where);
        return;
      }
    }
  }

  /// The children by RAFCON's ids.
  struct Inside {
    const RafconState* raw = nullptr;
    StateIndex index = kNoState;
  };
  using Children = std::unordered_map<std::string, Inside>;

  void add_inside(const RafconState& raw, StateIndex index) {
    Children children;
    std::set<std::string> taken;
    for (const auto& child : raw.children) {
      const std::string id = unique(identifier(child->name, child->id), taken);
      const StateIndex added = add(*child, index, id);
      if (!children.emplace(child->id, Inside{child.get(), added}).second)
        error("duplicate-state", "two states have the id " + quote(child->id), child->where);
    }
    for (const RafconLink& transition : raw.transitions)
      add_transition(raw, index, transition, children);
    for (const auto& child : raw.children) {
      if (raw.kind != StateKind::Barrier || child->kind == StateKind::Decider)
        end_unconnected(raw, *child, children.at(child->id).index);
    }
    if (raw.kind == StateKind::Hierarchy && !mission_.states[index].start) {
      mission_.states[index].start = Target{StateId(), std::string(kAbortedName)};
      diagnostics_.warning("missing-start", quote(raw.name) + " has no start: it aborts if it is reached",
                           raw.where);
    }
    for (const RafconLink& flow : raw.flows)
      add_flow(raw, index, flow, children);
  }

  /// An outcome without a transition, at which RAFCON waits until somebody draws one, aborts.
  void end_unconnected(const RafconState& around, const RafconState& raw, StateIndex index) {
    for (const auto& [id, name] : names(raw).outcomes) {
      auto& transitions = mission_.states[index].transitions;
      if (id < 0 || std::ranges::find(transitions, name, &StateTransition::outcome) != transitions.end())
        continue;
      transitions.push_back({name, Target{StateId(), std::string(kAbortedName)}, raw.where});
      diagnostics_.warning("unconnected-outcome",
                           "the outcome " + quote(name) + " of " + quote(raw.name) +
                               " has no transition: " + quote(around.name) + " aborts if it is reached",
                           raw.where);
    }
  }

  std::optional<Target> target(const RafconState& raw, const RafconLink& link, const Children& children) {
    if (link.to_state.empty() || link.to_state == raw.id) {
      const auto& outcomes = names(raw).outcomes;
      const auto found = link.to ? outcomes.find(*link.to) : outcomes.end();
      if (found != outcomes.end()) return Target{StateId(), found->second};
      error("unknown-outcome", "a transition leads to an outcome that " + quote(raw.name) + " does not have",
            link.where);
      return std::nullopt;
    }
    const auto found = children.find(link.to_state);
    if (found != children.end()) return Target{mission_.states[found->second.index].id, {}};
    error("unknown-state",
          "a transition leads to " + quote(link.to_state) + ", which is not in " + quote(raw.name),
          link.where);
    return std::nullopt;
  }

  void add_transition(const RafconState& raw, StateIndex index, const RafconLink& link,
                      const Children& children) {
    const bool start = link.from_state.empty() || link.from_state == raw.id;
    const auto from = children.find(link.from_state);
    if (!start && from == children.end()) {
      return error(
          "unknown-state",
          "a transition comes from " + quote(link.from_state) + ", which is not in " + quote(raw.name),
          link.where);
    }
    std::string outcome;
    if (!start) {
      const auto& outcomes = names(*from->second.raw).outcomes;
      const auto found = link.from ? outcomes.find(*link.from) : outcomes.end();
      if (found == outcomes.end()) {
        return error(
            "unknown-outcome",
            "a transition comes from an outcome that " + quote(from->second.raw->name) + " does not have",
            link.where);
      }
      outcome = found->second;
    }
    // Transitions between the states of a barrier and its decider have no effect in RAFCON.
    const bool decoration =
        raw.kind == StateKind::Barrier && (start || from->second.raw->kind != StateKind::Decider);
    if (decoration) return;
    auto to = target(raw, link, children);
    if (!to) return;
    if (start) {
      mission_.states[index].start = std::move(*to);
      return;
    }
    // If several leave one outcome, RAFCON takes the last.
    auto& transitions = mission_.states[from->second.index].transitions;
    std::erase_if(transitions, [&](const StateTransition& earlier) { return earlier.outcome == outcome; });
    transitions.push_back({outcome, std::move(*to), link.where});
  }

  void add_flow(const RafconState& raw, StateIndex index, const RafconLink& link, const Children& children) {
    auto from = port(raw, link.from_state, link.from, true, children);
    auto to = port(raw, link.to_state, link.to, false, children);
    if (from && to) {
      mission_.states[index].flows.push_back({std::move(*from), std::move(*to), link.where});
      return;
    }
    diagnostics_.warning("dropped-flow",
                         "a data flow in " + quote(raw.name) + " connects ports that do not exist",
                         link.where);
  }

  std::optional<FlowPort> port(const RafconState& raw, const std::string& state,
                               std::optional<std::int64_t> id, bool source, const Children& children) {
    if (!id) return std::nullopt;
    const auto inside = children.find(state);
    const Names& shown = names(inside == children.end() ? raw : *inside->second.raw);
    const auto look = [&](const std::map<std::int64_t, std::string>& names,
                          Owner owner) -> std::optional<FlowPort> {
      const auto found = names.find(*id);
      if (found == names.end()) return std::nullopt;
      const StateId child = owner == Owner::Child ? mission_.states[inside->second.index].id : StateId();
      return FlowPort{owner, child, found->second};
    };
    if (inside != children.end()) return look(source ? shown.outputs : shown.inputs, Owner::Child);
    if (state != raw.id) return std::nullopt;
    if (auto own = source ? look(shown.inputs, Owner::Inputs) : look(shown.outputs, Owner::Outputs))
      return own;
    return look(shown.variables, Owner::Variables);
  }

  /// Counts with all libraries expanded; each library is counted once and added for every use.
  RafconCounts count(const RafconState& state) {
    RafconCounts counts{1, 0, state.transitions.size(), state.flows.size()};
    const auto plus = [&](const RafconCounts& more) {
      counts.states = std::min(counts.states + more.states, kMost);
      counts.library_states = std::min(counts.library_states + more.library_states, kMost);
      counts.transitions = std::min(counts.transitions + more.transitions, kMost);
      counts.data_flows = std::min(counts.data_flows + more.data_flows, kMost);
    };
    for (const auto& child : state.children)
      plus(count(*child));
    if (state.kind != StateKind::Library) return counts;
    counts.library_states = 1;
    const auto [known, fresh] = counted_.try_emplace(state.library);
    if (fresh) {
      open_.insert(state.library);
      const RafconCounts inside = count(*files_.libraries.at(state.library));
      open_.erase(state.library);
      counted_[state.library] = inside;
    } else if (open_.contains(state.library)) {
      error("library-recursion", "library " + quote(state.library) + " contains itself", state.where);
    }
    plus(counted_[state.library]);
    return counts;
  }

  const RafconFiles& files_;
  Diagnostics& diagnostics_;
  Mission mission_;
  std::map<std::string, std::string> library_names_;
  std::map<const RafconState*, Names> names_;
  std::set<std::string> action_names_;
  std::map<std::string, RafconCounts> counted_;
  std::set<std::string> open_;
};

}  // namespace

std::optional<RafconImport> convert(const RafconFiles& files, Diagnostics& diagnostics) {
  return Converter(files, diagnostics).run();
}

}  // namespace segue::mission::detail
