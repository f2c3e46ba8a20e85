// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/type_info.hpp>

#include <cstddef>
#include <span>

/// Between the flat layout (flat.hpp) and CDR (cdr_object.hpp), without an object in between: what shared
/// memory holds is what goes to another host, and the other way round. Vectors of numbers are copied as a
/// whole. Allocates nothing. Any thread.
///
/// All bytes are untrusted: nothing is read or written out of bounds, and containers nest at most 100 levels
/// deep.
namespace segue::type {

/// How many bytes flat_to_cdr() will need, the header included; 0 where can_flatten() or can_encode_cdr() is
/// false, where the lengths in `flat` are not those of its bytes, and for a sequence or text of 4 Gi items or
/// more.
std::size_t cdr_size_of_flat(const TypeInfo& info, std::span<const std::byte> flat) noexcept;

/// Writes what `flat` holds in little endian into exactly as many bytes as cdr_size_of_flat() said; the bytes
/// are those that write_cdr() writes for the object. `flat` may change meanwhile: false where its lengths are
/// other ones now. Values of booleans and enums are passed on as they are; is_flat() checks them.
bool flat_to_cdr(const TypeInfo& info, std::span<const std::byte> flat, std::span<std::byte> cdr) noexcept;

/// How many bytes cdr_to_flat() will need; 0 where can_flatten() or can_encode_cdr() is false, and for a
/// message of which the lengths are not those of its bytes.
std::size_t flat_size_of_cdr(const TypeInfo& info, std::span<const std::byte> cdr) noexcept;

/// Writes what a message of either byte order holds into exactly as many bytes as flat_size_of_cdr() said, so
/// that read_flat() accepts them. True where read_cdr() accepts the message. Gaps between the members of
/// structs become zero. The message must not change meanwhile.
bool cdr_to_flat(const TypeInfo& info, std::span<const std::byte> cdr, std::span<std::byte> flat) noexcept;

}  // namespace segue::type
