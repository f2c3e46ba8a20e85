// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/type/type.hpp>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace segue::type {

/// How an object lies in memory, in bytes.
struct MemoryLayout {
  std::size_t size = 0;
  std::size_t alignment = 1;
};

/// The layout that C++ gives an object of the type here (System V ABI, libstdc++): numbers, enums, texts,
/// vectors, arrays and compounds of these. Unsupported for other types, and where the size would overflow.
Result<MemoryLayout> memory_layout(const Type& type);

/// The compound with these members one after the other, with their offsets and its size as of a C++ struct.
/// Unsupported as memory_layout().
Result<Type> make_compound(std::string name, std::vector<std::pair<std::string, const Type*>> members);

}  // namespace segue::type
