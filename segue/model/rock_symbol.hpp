// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/text.hpp>
#include <segue/type/value.hpp>

#include <string_view>

namespace segue::model::detail {

/// Whether it is a text that Rock takes for a symbol of an enumeration: ":FAST".
inline bool is_symbol(const type::Value& value) {
  return value.is_string() && value.as_string().starts_with(':') &&
         is_identifier(std::string_view(value.as_string()).substr(1));
}

/// The name of a symbol: "FAST".
inline type::Value symbol_text(const type::Value& symbol) {
  type::Value text(symbol.as_string().substr(1));
  text.set_mark(symbol.mark());
  return text;
}

}  // namespace segue::model::detail
