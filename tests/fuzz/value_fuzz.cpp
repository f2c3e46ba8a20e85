// SPDX-License-Identifier: Apache-2.0
//
// Checking and CDR. The first byte chooses the type, the second whether the rest is a CDR message or YAML.
#include "require.hpp"

#include <segue/type/cdr.hpp>
#include <segue/type/conform.hpp>
#include <segue/type/yaml.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace segue::type {
namespace {

using fuzz::require;

Type numeric(NumericCategory category, std::size_t size, std::int64_t tick = 0) {
  Type type;
  type.kind = TypeKind::Numeric;
  type.name = "/number";
  type.category = category;
  type.size = size;
  type.nanoseconds_per_tick = tick;
  return type;
}

Type made_of(TypeKind kind, const Type& element, std::string container_kind, std::size_t count = 0) {
  Type type;
  type.kind = kind;
  type.name = "/holder";
  type.element = &element;
  type.container_kind = std::move(container_kind);
  type.count = count;
  return type;
}

/// Types that use every kind, a recursive one among them.
struct Types {
  Type byte = numeric(NumericCategory::Unsigned, 1);
  Type boolean = numeric(NumericCategory::Bool, 1);
  Type int16 = numeric(NumericCategory::Signed, 2);
  Type uint64 = numeric(NumericCategory::Unsigned, 8);
  Type single = numeric(NumericCategory::Float, 4);
  Type real = numeric(NumericCategory::Float, 8);
  Type duration = numeric(NumericCategory::Signed, 8, 1'000'000);
  Type text = made_of(TypeKind::Container, byte, "/std/string");
  Type reals = made_of(TypeKind::Container, real, "/std/vector");
  Type three = made_of(TypeKind::Array, int16, {}, 3);
  Type maybe = made_of(TypeKind::Container, text, "/std/optional");
  Type none = made_of(TypeKind::Array, real, {}, 0);
  Type nones = made_of(TypeKind::Container, none, "/std/vector");
  Type alias = made_of(TypeKind::Alias, single, {});
  Type mode;
  Type empty;
  Type all;
  Type tree;
  Type forest = made_of(TypeKind::Container, tree, "/std/vector");

  Types() {
    mode.kind = TypeKind::Enum;
    mode.name = "/mode";
    mode.size = 4;
    mode.symbols = {{"IDLE", 0}, {"DRIVE", 1}, {"REVERSE", -1}};
    empty.kind = TypeKind::Compound;
    all.kind = TypeKind::Compound;
    all.name = "/all";
    all.fields = {{"b", &byte, 0},    {"bool", &boolean, 0},  {"u64", &uint64, 0},  {"f", &alias, 0},
                  {"t", &text, 0},    {"list", &reals, 0},    {"three", &three, 0}, {"maybe", &maybe, 0},
                  {"mode", &mode, 0}, {"wait", &duration, 0}, {"empty", &empty, 0}, {"nones", &nones, 0}};
    tree.kind = TypeKind::Compound;
    tree.name = "/tree";
    tree.fields = {{"name", &text, 0}, {"children", &forest, 0}};
  }

  [[nodiscard]] const Type& pick(std::uint8_t number) const {
    const std::array<const Type*, 8> types = {&all, &tree, &forest, &reals, &text, &maybe, &nones, &mode};
    return *types.at(number % types.size());
  }
};

void round_trip(const Value& value, const Type& type) {
  const auto bytes = encode_cdr(value, type);
  if (!bytes) return;
  const auto decoded = decode_cdr(*bytes, type);
  require(decoded.has_value(), "what is encoded decodes");
  require(encode_cdr(*decoded, type).value_or(std::vector<std::byte>{}) == *bytes,
          "the decoded encodes to the same bytes");
}

void decode(std::span<const std::byte> bytes, const Type& type) {
  const auto value = decode_cdr(bytes, type);
  if (!value) {
    require(!value.error().message.empty() && value.error().code != ErrorCode::Internal,
            "a refusal says why");
    return;
  }
  const auto again = encode_cdr(*value, type);
  require(again.has_value(), "what is decoded encodes");
  const auto decoded = decode_cdr(*again, type);
  require(decoded.has_value() && *decoded == *value, "what is encoded decodes equal");
  Diagnostics diagnostics;
  check_value(*value, type, "value", "f", diagnostics);
  require(std::ranges::all_of(diagnostics.items(),
                              [](const Diagnostic& d) { return d.code == "unknown-symbol"; }),
          "what is decoded passes its check: " + to_string(diagnostics));
}

void check(std::string_view text, const Type& type) {
  const auto value = parse_yaml(text, "f");
  if (!value) return;
  Diagnostics diagnostics;
  check_value(*value, type, "value", "f", diagnostics);
  // Encoding asks for more (every field, a known layout) but never for less.
  if (diagnostics.has_errors() && !std::ranges::all_of(diagnostics.items(), [](const Diagnostic& d) {
        return d.code == "unknown-symbol";
      })) {
    require(!encode_cdr(*value, type), "what fails its check does not encode: " + to_string(diagnostics));
  }
  round_trip(*value, type);
}

}  // namespace
}  // namespace segue::type

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const segue::type::Types types;
  if (size < 2) return 0;
  const segue::type::Type& type = types.pick(data[0]);
  const std::span rest(data + 2, size - 2);
  if (data[1] % 2 == 0) {
    segue::type::decode(std::as_bytes(rest), type);
  } else {
    segue::type::check({reinterpret_cast<const char*>(rest.data()), rest.size()}, type);
  }
  return 0;
}
