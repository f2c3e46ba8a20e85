// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/mission/mission_port.hpp>
#include <segue/type/value.hpp>

#include <string>
#include <vector>

namespace segue::mission {

/// An output that is a field of what the operation answers: "route.points", or "value" for the answer itself.
struct ResultField {
  std::string output;
  std::string field;
  SourcePlace where;
  friend bool operator==(const ResultField&, const ResultField&) = default;
};

/// An action that an instance of a pool of processes carries out by an operation. While it runs, it holds a
/// unit of the resource that is named like the pool.
struct PoolCall {
  std::string pool;
  std::string operation;
  type::Value arguments;     ///< by name; "{input}", at any depth, stands for the value of that input
  std::string outcome_from;  ///< the field with the name of the outcome; empty: the first one
  std::vector<ResultField> outputs;
  Duration timeout = std::chrono::seconds(60);  ///< for the answer of one instance
  SourcePlace where;                            ///< of the operation
  friend bool operator==(const PoolCall&, const PoolCall&) = default;
};

/// The part of an answer that ResultField::field names; nullptr if it has none.
const type::Value* field_of(const type::Value& answer, std::string_view field);

}  // namespace segue::mission
