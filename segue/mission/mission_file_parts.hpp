// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/mission.hpp>
#include <segue/model/reader.hpp>

#include <string>
#include <string_view>
#include <vector>

/// Parts of the reader and the writer of mission files. Internal.
namespace segue::mission::detail {

using model::detail::Fields;
using model::detail::Source;

/// Names of ports, outcomes and libraries may be any one-line text; reports other names and returns false.
bool check_free_name(std::string_view name, std::string_view what, const type::Value& at,
                     const Source& source);

/// Reads "inputs", "outputs" and the like: each entry is a type, or a map of type and default.
std::vector<Port> read_ports(Fields& fields, std::string_view key, const Source& source);
/// Reads values by port, of a state that uses an action or library.
std::vector<PortValue> read_values(Fields& fields, std::string_view key, const Source& source);
/// Reads one name or a list of distinct ones, without those that every state has. Default: "success".
std::vector<std::string> read_outcomes(Fields& fields, const Source& source);
/// Reads "world": facts without inputs.
std::vector<Fact> read_world(Fields& fields, const Source& source);
/// Reads "types", "objects" and "predicates".
FactVocabulary read_vocabulary(Fields& fields, const Source& source);
/// Reads "observe": facts without inputs, and what they are bound to.
std::vector<ObservedFact> read_observed(Fields& fields, const Source& source);
/// Reads "preconditions" and "resources", of an action or a container.
void read_needs(std::vector<Fact>& preconditions, std::vector<ResourceUse>& resources, Fields& fields,
                const Source& source);
/// Reads what an action declares of its facts, resources and class, and what is expected of it.
void read_declarations(Action& action, Fields& fields, const Source& source);
/// Reads "world_data".
std::vector<DeclaredData> read_declared_data(Fields& fields, const Source& source);
/// Reads a file's name, or {text: ...}.
Script read_script(const type::Value& value, const std::string& what, const Source& source);
/// Reads "run", if there is one.
Procedure read_run(Fields& action, const Source& source);
Action read_action(const std::string& name, const type::Value& value, const Source& source);
/// Reads 'run' of an action that is a controller.
ControllerUse read_controller(Fields& fields, const Source& source);
/// Reads 'run' of an action that is a call of a pool.
PoolCall read_pool_call(Fields& fields, const Source& source);
/// The condition of an entry that must have one; otherwise an error, which names the forms that it may have.
std::optional<model::RobotCondition> read_one_condition(Fields& fields, std::string_view forms,
                                                        const Source& source);
/// Reads "observe" of a resource, if there is one.
std::optional<ObservedUnits> read_observed_units(Fields& resource, const Source& source);
Resource read_resource(const std::string& name, const type::Value& value, const Source& source);

/// The writers append nothing for empty lists.
void write_ports(type::ValueMap& map, std::string_view key, const std::vector<Port>& ports);
void write_values(type::ValueMap& map, std::string_view key, const std::vector<PortValue>& values);
void write_vocabulary(type::ValueMap& map, const FactVocabulary& vocabulary);
void write_outcomes(type::ValueMap& map, const std::vector<std::string>& outcomes);
void write_needs(type::ValueMap& map, const std::vector<Fact>& preconditions,
                 const std::vector<ResourceUse>& resources);
type::Value write_action(const Action& action);
type::Value write_controller(const ControllerUse& use);
type::Value write_pool_call(const PoolCall& call);
void write_declared_data(type::ValueMap& map, const std::vector<DeclaredData>& data);
type::Value write_script(const Script& script);
void write_observed(type::ValueMap& map, const std::vector<ObservedFact>& observed);
type::Value write_observed_units(const ObservedUnits& observed);
type::Value write_resource(const Resource& resource);

}  // namespace segue::mission::detail
