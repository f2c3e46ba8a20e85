// SPDX-License-Identifier: Apache-2.0
#include "require.hpp"

#include <segue/type/typelib.hpp>
#ifdef SEGUE_CDR
#include <segue/type/cdr.hpp>
#endif

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

using segue::fuzz::require;

namespace segue::type {
namespace {

// What can be done with any type must work with whatever was read.
void use(const Type& type) {
  require(!definition(type).empty(), "every type has a definition");
  require(structural_hash(type) == structural_hash(type), "a hash is a function");
  (void)type.is_complete();
  (void)type.resolved();
#ifdef SEGUE_CDR
  const std::array<std::byte, 64> message{{std::byte{0}, std::byte{1}}};
  const auto value = decode_cdr(message, type);
  if (value) require(encode_cdr(*value, type).has_value(), "what is decoded encodes");
#endif
}

void read(std::string_view text) {
  Diagnostics diagnostics;
  auto registry = read_typelib(text, "f", diagnostics);
  require(registry.has_value() != diagnostics.has_errors(),
          "a registry or errors: " + to_string(diagnostics));
  if (!registry) return;
  for (const Type* type : registry->types()) {
    use(*type);
    require(registry->find(type->name) == type, "every type is found by its name: " + type->name);
  }
  TypeRegistry copy;
  if (auto merged = copy.merge(*registry); !merged) return;  // it may contradict the numeric types
  require(copy.merge(*registry).has_value(), "merging again changes nothing");
  for (const Type* type : registry->types()) {
    const Type* copied = std::as_const(copy).find(type->name);
    require(copied != nullptr && structural_hash(*copied) == structural_hash(*type),
            "copies are equal: " + type->name);
  }
}

}  // namespace
}  // namespace segue::type

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  segue::type::read({reinterpret_cast<const char*>(data), size});
  return 0;
}
