// SPDX-License-Identifier: Apache-2.0
#include <segue/sample_link/sample_form.hpp>

#include <segue/type/flat.hpp>

#include <exception>

namespace segue::sample_link {

SampleForm form_of(const type::TypeInfo* info) {
  if (info == nullptr) return SampleForm::Untyped;
  return info->trivially_copyable ? SampleForm::Raw : SampleForm::Flat;
}

bool writes_in_place(const task::OutputPortBase& port) {
  return form_of(port.type()) == SampleForm::Raw || port.is_flat();
}

bool read_object(std::span<const std::byte> flat, std::uint64_t sequence, task::SampleSlot& object) noexcept {
  object.sequence = sequence;
  try {
    return type::read_flat(*object.owner->info(), object.value, flat);
  } catch (const std::exception&) {
    return false;  // out of memory
  }
}

}  // namespace segue::sample_link
