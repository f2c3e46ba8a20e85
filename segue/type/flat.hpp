// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/type_info.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

/// Objects with pointers inside (strings, vectors, optionals) as one run of bytes without any, for memory
/// that processes share. Not a wire format: byte order, sizes and layout are those of this machine and of
/// structural_hash. Real-time safe as far as the type's own resizing is: an object that once held as much
/// allocates nothing.
namespace segue::type {

/// How many bytes write_flat() will need for `object`; 0 for a type that cannot be flattened (info.hash says
/// nothing about it; see can_flatten).
std::size_t flat_size(const TypeInfo& info, const void* object) noexcept;

/// Whether every part of the type is known well enough: described structs, numbers, enums, strings,
/// sequences, arrays, optionals, Eigen matrices.
bool can_flatten(const TypeInfo& info) noexcept;

/// Writes `object` into `bytes` and answers how many were used; nothing where they are too few. `bytes` needs
/// no alignment beyond 8.
std::optional<std::size_t> write_flat(const TypeInfo& info, const void* object,
                                      std::span<std::byte> bytes) noexcept;

/// Reads into `object`. The bytes are untrusted: every length is checked against what is left, enums and
/// booleans against what they may be. False: they are not such an object, which then holds something valid
/// between old and new. May throw std::bad_alloc where the object must grow, never for a length that the
/// input does not justify.
bool read_flat(const TypeInfo& info, void* object, std::span<const std::byte> bytes);

}  // namespace segue::type
