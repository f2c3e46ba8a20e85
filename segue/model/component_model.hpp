// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/activity.hpp>
#include <segue/base/error.hpp>
#include <segue/base/result.hpp>
#include <segue/model/ids.hpp>
#include <segue/type/type.hpp>
#include <segue/type/value.hpp>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::model {

enum class Direction : std::uint8_t { Input, Output };
std::string_view to_string(Direction direction);

/// A port, or a family of ports that configure creates. A dynamic port is removed by cleanup.
struct PortModel {
  std::string
      name;  ///< the name; for a family a regular expression (ECMAScript) that the whole name must match
  Direction direction = Direction::Input;
  std::string type;      ///< canonical type name; empty: unknown, fits every type
  bool dynamic = false;  ///< created in configure
  bool pattern = false;  ///< `name` is a regular expression; implies dynamic
  std::string doc;
  friend bool operator==(const PortModel&, const PortModel&) = default;
};

/// A property of a component.
struct PropertyModel {
  std::string name;
  std::string type;
  type::Value default_value;
  bool live = false;  ///< may be set without leaving Running
  std::string doc;
  friend bool operator==(const PropertyModel&, const PropertyModel&) = default;
};

/// An argument of an operation.
struct ArgumentModel {
  std::string name;
  std::string type;
  std::string doc;
  friend bool operator==(const ArgumentModel&, const ArgumentModel&) = default;
};

/// An operation of a component.
struct OperationModel {
  std::string name;
  std::vector<ArgumentModel> arguments;
  std::string result;          ///< type name; empty: nothing
  bool caller_thread = false;  ///< runs in the caller's thread instead of the task's
  std::string doc;
  friend bool operator==(const OperationModel&, const OperationModel&) = default;
};

/// The interface of a component as data, readable without loading it.
struct ComponentModel {
  ComponentName name;
  std::string doc;
  std::string library;    ///< the library that implements it; empty: not installed, or from Rock
  bool abstract = false;  ///< only to be derived from
  std::vector<PortModel> ports;
  std::vector<PropertyModel> properties;
  std::vector<OperationModel> operations;
  Activity activity;
  std::vector<std::string> trigger_ports;   ///< PortDriven: only these, unless empty
  std::vector<std::string> descriptors;     ///< FileDescriptorDriven: the names of those that it may give
  std::vector<std::string> nominal_states;  ///< named sub-states of Running
  std::vector<std::string> error_states;    ///< named sub-states of RunTimeError
  std::vector<std::string> exclusive;       ///< devices it claims, whatever the network says
  /// The component guesses some names (inferred models): a port it lacks is then a warning, not an error.
  bool incomplete = false;
  std::string parent;         ///< Rock: whose interface it extends, until resolve_inheritance() has copied it
  bool own_activity = false;  ///< the model has an activity, so none is inherited
  SourceLocation where;

  /// Ignores `where`.
  friend bool operator==(const ComponentModel& a, const ComponentModel& b);

  /// The port of that name, static ones first, then families; nullptr if none fits.
  [[nodiscard]] const PortModel* find_port(std::string_view port, Direction direction) const;
  /// All that fit: the static one, or every family whose expression the name matches (some differ by type
  /// only).
  [[nodiscard]] std::vector<const PortModel*> find_ports(std::string_view port, Direction direction) const;
  [[nodiscard]] const PropertyModel* find_property(std::string_view property) const;
  [[nodiscard]] const OperationModel* find_operation(std::string_view operation) const;
  [[nodiscard]] bool has_dynamic_ports() const;
};

/// All component models known to a tool or a runtime, and the types they use.
class ComponentCatalog {
 public:
  /// Adds or replaces a model. Adds the output port `state` (/int32_t) that every task has.
  void add(ComponentModel model);
  [[nodiscard]] const ComponentModel* find(const ComponentName& name) const;
  [[nodiscard]] std::vector<const ComponentModel*> all() const;  ///< sorted by name
  [[nodiscard]] std::size_t size() const { return models_.size(); }
  /// Registers composite types such as "/std/vector</double>" under their names.
  void register_composite_types();

  [[nodiscard]] type::TypeRegistry& types() { return types_; }
  [[nodiscard]] const type::TypeRegistry& types() const { return types_; }

 private:
  std::map<ComponentName, ComponentModel> models_;
  type::TypeRegistry types_;
};

}  // namespace segue::model
