// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task/port.hpp>
#include <segue/task/sample.hpp>
#include <segue/type/type_info.hpp>

#include <cstddef>
#include <cstdint>
#include <span>

namespace segue::sample_link {

/// How the samples of a port are laid out in shared memory: not at all (ports of any type), as they are in
/// memory, or flattened (type/flat.hpp).
enum class SampleForm : std::uint8_t { Untyped, Raw, Flat };
SampleForm form_of(const type::TypeInfo* info);

/// Whether samples of the port are in that form from the beginning, so that they need no copy where they are
/// written to shared memory.
bool writes_in_place(const task::OutputPortBase& port);

/// Reads an object from a sample in the flat layout. False: the bytes are invalid, or no memory is left.
bool read_object(std::span<const std::byte> flat, std::uint64_t sequence, task::SampleSlot& object) noexcept;

}  // namespace segue::sample_link
