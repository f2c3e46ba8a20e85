// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission_script/persistent_variables.hpp>

#include <algorithm>
#include <array>
#include <string_view>

namespace segue::mission {

namespace {

constexpr std::string_view kSelf = "self.";

bool is_in_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

/// Whether the text goes on with "=", or with an operator and "=".
bool is_assignment(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
  if (text.starts_with("==")) return false;
  constexpr std::array<std::string_view, 5> kLong{"//", "**", "<<", ">>", ""};
  constexpr std::string_view kShort = "+-*/%&|^@";
  for (const std::string_view op : kLong) {
    if (text.starts_with(op) && text.substr(op.size()).starts_with('=')) return true;
  }
  return !text.empty() && kShort.find(text.front()) != std::string_view::npos &&
         text.substr(1).starts_with('=');
}

bool assigns_to_self(std::string_view text) {
  for (auto at = text.find(kSelf); at != std::string_view::npos; at = text.find(kSelf, at + 1)) {
    if (at > 0 && is_in_name(text[at - 1])) continue;
    const std::string_view name = text.substr(at + kSelf.size());
    const auto end = std::ranges::find_if_not(name, is_in_name);
    if (is_assignment(name.substr(static_cast<std::size_t>(end - name.begin())))) return true;
  }
  return false;
}

bool uses_them(std::string_view script) {
  return script.find("persistent_variables") != std::string_view::npos || assigns_to_self(script);
}

}  // namespace

bool uses_persistent_variables(const Mission& mission, const Action& action) {
  const auto* script = std::get_if<Script>(&action.run);
  if (script == nullptr) return false;
  if (!script->text.empty()) return uses_them(script->text);
  const auto text = read_file(script_file(mission, action));
  return text && uses_them(*text);
}

}  // namespace segue::mission
