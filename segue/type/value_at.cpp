// SPDX-License-Identifier: Apache-2.0
#include <segue/type/value_at.hpp>

namespace segue::type {

std::string text_at(const Value& map, std::string_view key) {
  const Value* text = map.find(key);
  return text != nullptr && text->is_string() ? text->as_string() : std::string();
}

}  // namespace segue::type
