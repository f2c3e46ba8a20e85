// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/error.hpp>
#include <segue/type/value.hpp>

#include <string>
#include <utility>

namespace segue::mission {

/// The place in a file at which something was declared. All are equal, so that missions compare by content.
struct SourcePlace : SourceLocation {
  SourcePlace() = default;
  // NOLINTNEXTLINE(google-explicit-constructor)
  SourcePlace(SourceLocation where) : SourceLocation(std::move(where)) {}
  friend bool operator==(const SourcePlace&, const SourcePlace&) { return true; }
};

/// An input, an output, a scoped variable or a global variable. `type` is any, bool, int, float, text, list
/// or map, or the name of another type, which accepts any value. `value` is the default; the text "$name"
/// stands for the global variable `name` at the time of reading, "$$name" for the text "$name".
struct Port {
  std::string name;
  std::string type = "any";
  type::Value value;
  SourcePlace where;
  bool from_world = false;  ///< an input that add_world_inputs() has added; its name is a WorldField
  friend bool operator==(const Port&, const Port&) = default;
};

/// A default with which a state overrides that of a port of its action or library.
struct PortValue {
  std::string port;
  type::Value value;
  SourcePlace where;
  friend bool operator==(const PortValue&, const PortValue&) = default;
};

}  // namespace segue::mission
