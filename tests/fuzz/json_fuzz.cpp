// SPDX-License-Identifier: Apache-2.0
#include "require.hpp"

#include <segue/type/json.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>

using segue::fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto value = segue::type::parse_json(text, "f");
  if (!value) {
    const auto& where = value.error().where;
    require(!value.error().message.empty(), "a refusal says why");
    require(where.line >= 1 && where.line <= std::ranges::count(text, '\n') + 1,
            "a refusal names a line of the text");
    return 0;
  }
  require(value->mark().line >= 1 && value->mark().column >= 1, "every value has its place");
  for (const int indent : {-1, 0, 2}) {
    const std::string written = segue::type::to_json(*value, indent);
    const auto again = segue::type::parse_json(written, "written");
    require(again.has_value(), again ? "" : to_string(again.error()) + "\n" + written);
    require(*again == *value, "what is written reads back equal:\n" + written);
  }
  return 0;
}
