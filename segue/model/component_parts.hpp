// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/component_model.hpp>
#include <segue/model/reader.hpp>
#include <segue/type/type.hpp>
#include <vector>

#include <string>

/// The formats that hold component models. Internal.
namespace segue::model::detail {

void read_own_components(const type::Value& root, ComponentCatalog& catalog, const Source& source);

/// An interface summary: `tasks` with input_ports, output_ports, dynamic_ports, properties, operations.
bool is_rock_interface(const type::Value& root);
void read_rock_interface(const type::Value& root, ComponentCatalog& catalog, const Source& source);

/// The output of Rock's exporter: project, task, inputPorts, outputPorts.
bool is_rock_export(const type::Value& root);
void read_rock_export(const type::Value& root, ComponentCatalog& catalog, const Source& source);

/// An .orogen file: the project's components in Ruby, of which its declarations are read, and nothing is
/// evaluated.
bool is_orogen(const std::string& file);
void read_orogen(std::string_view text, ComponentCatalog& catalog, const Source& source);

/// Converts a type name of Rock to ours. A leading '?' (a guess) makes the model incomplete; an unreadable
/// name becomes "" (fits everything) with a warning.
std::string rock_type_name(const std::string& written, ComponentModel& model, const type::Value& at,
                           const Source& source);
/// A default as oroGen has it: ":SYMBOL", 0 for false, Ruby expressions.
type::Value rock_default(const type::Value& written, const PropertyModel& property, const Source& source);
/// A port family from an expression that Rock searches for within names.
PortModel rock_family(const std::string& searched, Direction direction, std::string type);

/// Definitions of the types and of all types that they consist of, by name, without built-in types.
type::Value write_types(const std::vector<const type::Type*>& types);

/// Adds the definitions to the registry; a contradiction to an existing type is an error.
void read_types(const type::Value& definitions, type::TypeRegistry& registry, const Source& source);

}  // namespace segue::model::detail
