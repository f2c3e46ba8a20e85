// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rafcon/rafcon.hpp>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// The content of RAFCON's files, before it becomes a mission. Internal.
namespace segue::mission::detail {

struct RafconPort {
  std::string name;
  std::string type;
  type::Value value;
};
using RafconPorts = std::map<std::int64_t, RafconPort>;

/// A transition or data flow: ids of states, and numbers of outcomes or ports.
struct RafconLink {
  std::string from_state;  ///< empty: null
  std::optional<std::int64_t> from;
  std::string to_state;
  std::optional<std::int64_t> to;
  SourceLocation where;
};

struct RafconState {
  std::string id;
  std::string name;
  std::string description;
  StateKind kind = StateKind::Execution;
  RafconPorts inputs;
  RafconPorts outputs;
  RafconPorts variables;
  std::map<std::int64_t, std::string> outcomes;  ///< also -1 and -2
  std::vector<RafconLink> transitions;
  std::vector<RafconLink> flows;
  std::string library;  ///< "path/name"
  std::map<std::int64_t, type::Value> input_values;
  std::map<std::int64_t, type::Value> output_values;
  std::string script;
  type::Value notes{type::ValueMap{}};
  std::vector<std::unique_ptr<RafconState>> children;
  SourceLocation where;
};

/// The content of a core_data.json; children, script and notes are in other files.
std::unique_ptr<RafconState> read_core_data(std::string_view text, const std::string& file,
                                            Diagnostics& diagnostics);

/// Reads what the semantic data of a state declare for Segue, under the key "segue": of an action what it has
/// in a mission file (preconditions, effects, resources, pure ..., and `run` in place of its script), of a
/// container preconditions, resources and whether it is strict, of the root the world and the resources.
void declare(Action& action, const RafconState& state, Diagnostics& diagnostics);
void declare(State& container, const RafconState& state, Diagnostics& diagnostics);
/// Reads whether a state that stands for a library, or the root of one, is strict. Libraries can declare
/// nothing else, so anything else is an error, but for the world and the resources that the root of a machine
/// declares, which count when the machine is run by itself.
void declare_library(State& library, const RafconState& state, Diagnostics& diagnostics);
void declare(Mission& mission, const RafconState& root, Diagnostics& diagnostics);

/// A machine and the libraries it uses, by "path/name".
struct RafconFiles {
  std::unique_ptr<RafconState> root;
  std::map<std::string, std::unique_ptr<RafconState>> libraries;
};

/// Lets ports take any value whose values and data flows do not have the declared type, as RAFCON does, and
/// warns.
void widen_types(Mission& mission, Diagnostics& diagnostics);

/// Nothing if there are errors.
std::optional<RafconImport> convert(const RafconFiles& files, Diagnostics& diagnostics);

}  // namespace segue::mission::detail
