// SPDX-License-Identifier: Apache-2.0
//
// Mission files: whatever is read without errors validates without harm and is written back equal.
#include "require.hpp"

#include <segue/mission/mission_io.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using segue::fuzz::require;
  namespace mission = segue::mission;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  segue::Diagnostics diagnostics;
  const auto read = mission::read_mission(text, "f.yaml", diagnostics);
  require(read.has_value() != diagnostics.has_errors(), "a mission or errors");
  if (!read) return 0;
  (void)mission::validate(*read);
  const std::string written = mission::write_mission(*read);
  segue::Diagnostics again;
  const auto copy = mission::read_mission(written, "written.yaml", again);
  require(copy.has_value(), segue::to_string(again) + "\n" + written);
  require(*copy == *read, "what is written reads back equal:\n" + written);
  return 0;
}
