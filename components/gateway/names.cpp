// SPDX-License-Identifier: Apache-2.0
#include "names.hpp"

#include <segue/base/text.hpp>

#include <algorithm>
#include <array>
#include <cstdint>

namespace gateway {
namespace {

bool is_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

/// FNV-1a: the same on every computer.
std::uint32_t hash_of(std::string_view text) {
  std::uint32_t hash = 2166136261U;
  for (const char c : text)
    hash = (hash ^ static_cast<unsigned char>(c)) * 16777619U;
  return hash;
}

std::string hexadecimal(std::uint32_t number) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (int shift = 28; shift >= 0; shift -= 4)
    text += kDigits[(number >> static_cast<unsigned>(shift)) & 15U];
  return text;
}

/// A name without namespaces for a type such as "/std/vector</double>".
std::string flattened(std::string_view type) {
  std::string name;
  for (const char c : type) {
    if (is_word(c)) {
      name += c;
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  if (name.empty() || name.back() != '_') name += '_';
  return name + hexadecimal(hash_of(type));
}

}  // namespace

segue::Result<std::string> dds_topic_name(std::string_view topic) {
  std::string_view name = topic;
  if (name.starts_with('/')) name.remove_prefix(1);
  const bool valid = !name.empty() && !name.starts_with('/') && !name.ends_with('/') &&
                     name.find("//") == std::string_view::npos &&
                     std::ranges::all_of(name, [](char c) { return is_word(c) || c == '/'; });
  if (!valid) {
    return segue::fail(segue::ErrorCode::InvalidArgument,
                       "the topic " + segue::quote(topic) +
                           " must be a name of letters, digits and '_', with '/' between its parts");
  }
  return "rt/" + std::string(name);
}

std::string dds_type_name(std::string_view type) {
  if (type.empty()) return "std_msgs::msg::dds_::Empty_";
  const bool plain =
      type.starts_with('/') && std::ranges::all_of(type, [](char c) { return is_word(c) || c == '/'; });
  if (!plain) return "segue::msg::dds_::" + flattened(type) + "_";
  std::string spaces;
  std::string_view rest = type.substr(1);
  std::string_view last_space;
  for (std::size_t slash = rest.find('/'); slash != std::string_view::npos; slash = rest.find('/')) {
    last_space = rest.substr(0, slash);
    spaces += std::string(last_space) + "::";
    rest.remove_prefix(slash + 1);
  }
  if (spaces.empty()) spaces = "segue::";
  constexpr std::array<std::string_view, 3> kInterfaces = {"msg", "srv", "action"};
  if (std::ranges::find(kInterfaces, last_space) == kInterfaces.end()) spaces += "msg::";
  return spaces + "dds_::" + std::string(rest) + "_";
}

}  // namespace gateway
