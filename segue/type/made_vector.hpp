// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/described_type.hpp>

#include <cstddef>

namespace segue::type::detail {

/// A std::vector whose items' type is known at run time only, with the layout of libstdc++'s and memory from
/// the same place, so that both may change each other's objects. Not for users.
struct MadeVector {
  std::byte* first = nullptr;
  std::byte* last = nullptr;   ///< after the last item
  std::byte* limit = nullptr;  ///< after the memory

  // As TypeFunctions.
  static void construct(const TypeInfo& self, void* memory);
  static void destroy(const TypeInfo& self, void* object) noexcept;
  static void copy(const TypeInfo& self, void* to, const void* from);
};

extern const SequenceAccess kMadeVectorAccess;

}  // namespace segue::type::detail
