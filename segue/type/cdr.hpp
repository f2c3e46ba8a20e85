// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/type/type.hpp>
#include <segue/type/value.hpp>

#include <cstddef>
#include <span>
#include <vector>

// Built only with the CMake option SEGUE_CDR.
namespace segue::type {

/// OMG CDR (XCDR1 with the 4-byte encapsulation header, little endian), as ROS 2 puts it on the wire: enums
/// take 1, 2 or 8 bytes where their type does and 4 otherwise, an optional is a sequence of at most one item,
/// arrays have no length, a compound without fields is one byte, durations are their ticks. Fails where the
/// value does not fit the type, lacks a field, or the type is not complete.
Result<std::vector<std::byte>> encode_cdr(const Value& value, const Type& type);

/// Either byte order. Checks every length against what is left; never allocates more than the input
/// justifies. Enums come as symbols where the number has one. Up to three bytes of padding may follow.
Result<Value> decode_cdr(std::span<const std::byte> bytes, const Type& type);

}  // namespace segue::type
