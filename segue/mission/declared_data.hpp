// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/action.hpp>
#include <segue/mission/mission_port.hpp>
#include <segue/type/value.hpp>

#include <string>
#include <vector>

namespace segue::mission {

/// A function that a change of a fact applies to the data: "+holding" calls that function with the data and
/// the fact's arguments when a fact of that name becomes true, "-holding" when it becomes false.
struct DataEffect {
  std::string of;
  std::string function;
  SourcePlace where;
  friend bool operator==(const DataEffect&, const DataEffect&) = default;
};

/// Data that a mission attaches to its facts, with functions in Python by which they follow these
/// (ScriptedData).
struct DeclaredData {
  std::string name;
  type::Value initial;
  Script functions;
  std::vector<DataEffect> effects;
  SourcePlace where;
  friend bool operator==(const DeclaredData&, const DeclaredData&) = default;
};

}  // namespace segue::mission
