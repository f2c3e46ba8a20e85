// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <string>
#include <string_view>
#include <vector>

/// The part of Ruby that .orogen files are written in: calls with literal arguments, chained calls and
/// blocks. Internal.
namespace segue::model::detail {

/// `property("speed", "double", 0.5)`. Arguments are texts (also of symbols, which keep their colon, and of
/// regular expressions), numbers, booleans, null and lists; `options` are those with a key.
struct RubyCall {
  std::string name;
  std::vector<type::Value> arguments;
  type::ValueMap options;
};

/// One statement: a call and those chained to it. `understood` is false for all other Ruby.
struct RubyStatement {
  std::vector<RubyCall> calls;
  bool opens_block = false;
  bool closes_block = false;
  bool understood = true;
  type::Mark where;
};

/// InvalidFile where a text or a bracket is not closed; the message has the line.
Result<std::vector<RubyStatement>> read_ruby(std::string_view text, const std::string& file);

}  // namespace segue::model::detail
