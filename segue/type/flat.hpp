// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/type_info.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

/// Objects that contain pointers (strings, vectors, optionals), flattened to contiguous bytes for shared
/// memory. Not a wire format: byte order, sizes and layout are those of this machine, and match where
/// structural_hash and type name do. Members without a description are left out. As real-time safe as the
/// type's own resizing: an object with enough capacity allocates nothing; vectors keep their memory when they
/// shrink, Eigen and std::optional do not.
namespace segue::type {

/// How many bytes write_flat() will need for `object`, at least 1; 0 for a type that cannot be flattened (see
/// can_flatten) and for an object of a type that contains itself, nested more than 100 levels deep.
std::size_t flat_size(const TypeInfo& info, const void* object) noexcept;

/// Whether the type consists of described structs, numbers, enums, strings, sequences, arrays, optionals and
/// Eigen matrices only. False for types with custom conversions and for a TypeInfo that was not made by
/// describe.hpp.
bool can_flatten(const TypeInfo& info) noexcept;

/// Writes `object` into `bytes` and returns the number of bytes used, which is flat_size(); nothing where
/// `bytes` is too small or flat_size() is 0. `bytes` needs no alignment. Allocates nothing.
std::optional<std::size_t> write_flat(const TypeInfo& info, const void* object,
                                      std::span<std::byte> bytes) noexcept;

/// Reads `object` from exactly the bytes that write_flat() used. The bytes are untrusted and may even change
/// meanwhile: every length is checked against the remaining input, booleans and enums against their valid
/// values (for an enum, those that the bits of its symbols can express, as in C++). False: the bytes are
/// invalid; `object` is then valid but may be partly assigned. May throw std::bad_alloc where the object must
/// grow, but never for a length that exceeds the input.
bool read_flat(const TypeInfo& info, void* object, std::span<const std::byte> bytes);

/// Whether read_flat() would accept the bytes, found without an object. Allocates nothing.
bool is_flat(const TypeInfo& info, std::span<const std::byte> bytes) noexcept;

/// Whether are_valid_bytes() can be false for this type: it contains booleans or enums.
bool has_invalid_bytes(const TypeInfo& info) noexcept;
/// Whether bytes are those of an object, as far as that can be told: booleans and enums are checked as
/// read_flat() does. `object` needs the size and alignment of a trivially copyable type. Allocates nothing;
/// costs nothing for types without booleans and enums.
bool are_valid_bytes(const TypeInfo& info, const void* object) noexcept;

}  // namespace segue::type
