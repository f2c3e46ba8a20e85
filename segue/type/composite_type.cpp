// SPDX-License-Identifier: Apache-2.0
#include <segue/type/composite_type.hpp>

#include <array>
#include <charconv>
#include <limits>
#include <string>
#include <utility>

namespace segue::type::detail {
namespace {

constexpr std::size_t kPointerSize = 8;

CompositeName split_array(std::string_view name) {
  const std::size_t open = name.rfind('[');
  if (open == std::string_view::npos) return {};
  const std::string_view digits = name.substr(open + 1, name.size() - open - 2);
  CompositeName composite{TypeKind::Array, name.substr(0, open), {}, 0};
  const auto [end, status] = std::from_chars(digits.data(), digits.data() + digits.size(), composite.count);
  if (status != std::errc{} || end != digits.data() + digits.size()) return {};
  return composite;
}

std::string name_of(const CompositeName& composite, const std::string& element) {
  if (composite.kind == TypeKind::Array) return element + "[" + std::to_string(composite.count) + "]";
  if (composite.kind == TypeKind::Pointer) return element + "*";
  return std::string(composite.container_kind) + "<" + element + ">";
}

}  // namespace

CompositeName split_composite(std::string_view name) {
  if (name.ends_with(']')) return split_array(name);
  if (name.ends_with('*')) return {TypeKind::Pointer, name.substr(0, name.size() - 1), {}, 0};
  static constexpr std::array<std::string_view, 2> kKinds = {"/std/vector", "/std/optional"};
  for (const std::string_view kind : kKinds) {
    const std::size_t inner = kind.size() + 1;
    if (name.size() <= inner || !name.starts_with(kind) || name[kind.size()] != '<' || !name.ends_with('>'))
      continue;
    return {TypeKind::Container, name.substr(inner, name.size() - inner - 1), kind, 0};
  }
  return {};
}

std::optional<Type> make_composite(const CompositeName& composite, const Type& element) {
  Type type;
  type.kind = composite.kind;
  type.name = name_of(composite, element.name);
  type.element = &element;
  type.container_kind = composite.container_kind;
  type.count = composite.count;
  if (type.kind == TypeKind::Pointer) type.size = kPointerSize;
  if (type.kind != TypeKind::Array) return type;
  constexpr std::size_t kMost = std::numeric_limits<std::size_t>::max() / 2;
  if (element.size > 0 && composite.count > kMost / element.size) return std::nullopt;
  type.size = element.size * composite.count;
  return type;
}

}  // namespace segue::type::detail
