// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/mission.hpp>
#include <segue/model/reader.hpp>

#include <string>
#include <string_view>
#include <vector>

/// What the readers and writers of this folder share. Internal.
namespace segue::mission::detail {

using model::detail::Fields;
using model::detail::Source;

/// Ports, outcomes and libraries may be called anything that fits into a line; reports and returns false for
/// others.
bool check_free_name(std::string_view name, std::string_view what, const type::Value& at,
                     const Source& source);

/// "inputs", "outputs" and the like: each entry a type, or a map of type and default.
std::vector<Port> read_ports(Fields& fields, std::string_view key, const Source& source);
/// Values by port, for what uses an action or library.
std::vector<PortValue> read_values(Fields& fields, std::string_view key, const Source& source);
/// A list of names, or one; each once, none of those that every state has. Without any: "success".
std::vector<std::string> read_outcomes(Fields& fields, const Source& source);
/// "world": facts without inputs.
std::vector<Fact> read_world(Fields& fields, const Source& source);
Action read_action(const std::string& name, const type::Value& value, const Source& source);
Resource read_resource(const std::string& name, const type::Value& value, const Source& source);

/// Appends nothing where there is nothing to say.
void write_ports(type::ValueMap& map, std::string_view key, const std::vector<Port>& ports);
void write_values(type::ValueMap& map, std::string_view key, const std::vector<PortValue>& values);
void write_outcomes(type::ValueMap& map, const std::vector<std::string>& outcomes);
type::Value write_action(const Action& action);
type::Value write_resource(const Resource& resource);

}  // namespace segue::mission::detail
