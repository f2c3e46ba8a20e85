// SPDX-License-Identifier: Apache-2.0
#include "require.hpp"

#include <segue/type/yaml.hpp>

#include <cstddef>
#include <cstdint>

using segue::fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto value = segue::type::parse_yaml(text, "f");
  if (!value) {
    require(!value.error().message.empty() && value.error().where.line >= 1, "a refusal says why and where");
    return 0;
  }
  const std::string written = segue::type::to_yaml(*value);
  const auto again = segue::type::parse_yaml(written, "written");
  require(again.has_value(), again ? "" : to_string(again.error()) + "\n" + written);
  require(*again == *value, "what is written reads back equal:\n" + written);
  require(segue::type::to_yaml(*again) == written, "writing again changes nothing:\n" + written);
  return 0;
}
