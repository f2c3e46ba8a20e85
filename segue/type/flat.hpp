// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/type_info.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

/// Objects with pointers inside (strings, vectors, optionals) as one run of bytes without any, for memory
/// that processes share. Not a wire format: byte order, sizes and layout are those of this machine and of
/// structural_hash (with the name, which tells how matrices lie). Members that are not named do not travel.
/// Real-time safe as far as the type's own resizing is: an object that holds as much allocates nothing; a
/// vector keeps its memory when it shrinks, Eigen and std::optional do not.
namespace segue::type {

/// How many bytes write_flat() will need for `object`, at least 1; 0 for a type that cannot be flattened (see
/// can_flatten) and for an object of a type that contains itself, nested more than 100 levels deep.
std::size_t flat_size(const TypeInfo& info, const void* object) noexcept;

/// Whether every part of the type is known well enough: described structs, numbers, enums, strings,
/// sequences, arrays, optionals, Eigen matrices. Not types that convert themselves to values and back, nor a
/// TypeInfo that no describe.hpp made.
bool can_flatten(const TypeInfo& info) noexcept;

/// Writes `object` into `bytes` and answers how many were used, as flat_size() says; nothing where they are
/// too few or flat_size() is 0. `bytes` needs no alignment. Allocates nothing.
std::optional<std::size_t> write_flat(const TypeInfo& info, const void* object,
                                      std::span<std::byte> bytes) noexcept;

/// Reads into `object` exactly what write_flat() used. The bytes are untrusted and may even change meanwhile:
/// every length is checked against what is left, booleans and enums against what they may be (for an enum:
/// what the bits of its symbols can express, as C++ has it). False: they are not such an object, which then
/// holds something valid between old and new. May throw std::bad_alloc where the object must grow, never for
/// a length that the input does not justify.
bool read_flat(const TypeInfo& info, void* object, std::span<const std::byte> bytes);

}  // namespace segue::type
