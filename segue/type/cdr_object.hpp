// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/type_info.hpp>

#include <cstddef>
#include <optional>
#include <span>

/// Objects of described C++ types as OMG CDR (XCDR1 with its 4-byte encapsulation header), as ROS 2 puts them
/// on the wire: the bytes that cdr.hpp writes for their values, but directly from memory. Numbers and structs
/// whose layout in memory is that of CDR are copied as a whole. Needs no library. Any thread.
namespace segue::type {

/// Whether the type consists of described structs, numbers, enums, strings, sequences, arrays, optionals and
/// Eigen matrices only. False for types with other custom conversions, and for a TypeInfo that was not made
/// by describe.hpp.
bool can_encode_cdr(const TypeInfo& info) noexcept;

/// How many bytes write_cdr() will need for `object`, the header included; 0 for a type that cannot be
/// encoded (see can_encode_cdr), for a sequence or text of 4 Gi items or more, and for an object of a type
/// that contains itself, nested more than 100 levels deep.
std::size_t cdr_size(const TypeInfo& info, const void* object) noexcept;

/// Writes `object` in little endian into `bytes` and returns the number of bytes used, which is cdr_size();
/// nothing where `bytes` is too small or cdr_size() is 0. `bytes` needs no alignment; gaps in it become zero.
/// Allocates nothing.
std::optional<std::size_t> write_cdr(const TypeInfo& info, const void* object,
                                     std::span<std::byte> bytes) noexcept;

/// Reads `object` from a message of either byte order. The bytes are untrusted: every length is checked
/// against the remaining input, booleans and enums as read_flat() does, and at most three bytes may follow
/// (of padding). False: the bytes are invalid; `object` is then valid but may be partly assigned. Reuses the
/// memory that `object` has. May throw std::bad_alloc where the object must grow, but never for a length that
/// exceeds the input. The bytes must not change meanwhile.
bool read_cdr(const TypeInfo& info, void* object, std::span<const std::byte> bytes);

}  // namespace segue::type
