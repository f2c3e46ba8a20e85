// SPDX-License-Identifier: Apache-2.0
//
// Texts of .msg, .srv and .action files. The first byte chooses the kind.
#include "require.hpp"

#include <segue/ros2/interface_text.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace {

using segue::fuzz::require;
using namespace segue::ros2;

/// The fields of a message as its file may have them.
std::string written(const MessageDefinition& message) {
  std::string text;
  for (const FieldDefinition& field : message.fields) {
    std::string type = to_string(field.type);
    // In files, messages have no "msg/" in their names.
    if (const auto kind = type.find("/msg/"); kind != std::string::npos) type.erase(kind, 4);
    text += type + " " + field.name + "\n";
  }
  return text;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  static constexpr std::array<const char*, 3> kKinds{"msg", "srv", "action"};
  const InterfaceName name{"fuzzed_msgs", kKinds.at(data[0] % 3U), "Fuzzed"};
  const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
  segue::Diagnostics diagnostics;
  const auto messages = read_interface(name, text, "f", diagnostics);
  require(messages.empty() == diagnostics.has_errors(), "it is read, or it is said why not");
  for (const segue::Diagnostic& one : diagnostics.items()) {
    require(one.where.line >= 1 && one.where.line <= std::ranges::count(text, '\n') + 1,
            "a refusal names a line of the text");
  }
  if (messages.empty() || name.kind != "msg") return 0;
  segue::Diagnostics found;
  const std::string again = written(messages[0]);
  const auto copies = read_interface(name, again, "again", found);
  require(copies.size() == 1, again + to_string(found));
  require(std::ranges::equal(copies[0].fields, messages[0].fields,
                             [](const FieldDefinition& a, const FieldDefinition& b) {
                               return a.name == b.name && a.type == b.type;
                             }),
          "what is written reads back equal:\n" + again);
  return 0;
}
