// SPDX-License-Identifier: Apache-2.0
#include "cdr_output.hpp"

#include <segue/type/cdr_flat.hpp>
#include <segue/type/cdr_object.hpp>

#include <new>
#include <utility>

namespace ros2 {

using segue::task::SampleRef;

CdrOutput::CdrOutput(segue::task::Component& component, const std::string& name,
                     const segue::ros2::MessageCodec& message, const std::string& doc,
                     const std::string& topic, std::function<void()> on_commit)
    : type_(message.info()),
      port_(
          component, name, &type_, std::string(),
          segue::task::PortOptions{
              .dynamic = true, .doc = doc, .flat = true, .on_commit = std::move(on_commit), .topic = topic}) {
}

CdrOutput::Outcome CdrOutput::publish(std::span<const std::byte> message) noexcept {
  auto why = Outcome::Lost;
  SampleRef sample = make(message, why);
  return sample ? publish(std::move(sample)) : why;
}

CdrOutput::Outcome CdrOutput::publish(SampleRef sample) noexcept {
  return port_.publish(sample.detach()) == segue::task::WriteResult::Refused ? Outcome::Refused
                                                                             : Outcome::Published;
}

SampleRef CdrOutput::make(std::span<const std::byte> message, Outcome& why) noexcept {
  why = Outcome::Lost;
  try {
    SampleRef sample = room_for(message, why);
    if (sample && decode(message, *sample.get())) return sample;
    if (sample) why = Outcome::Corrupt;
  } catch (const std::bad_alloc&) {
  }
  return {};
}

SampleRef CdrOutput::room_for(std::span<const std::byte> message, Outcome& why) {
  if (!port_.is_flat()) return SampleRef::adopt(port_.acquire());
  const std::size_t size = segue::type::flat_size_of_cdr(type_, message);
  if (size > 0) return SampleRef::adopt(port_.acquire_flat(size));
  why = Outcome::Corrupt;
  return {};
}

bool CdrOutput::decode(std::span<const std::byte> message, segue::task::SampleSlot& slot) const {
  if (slot.flat_size == 0) return segue::type::read_cdr(type_, slot.value, message);
  return segue::type::cdr_to_flat(type_, message, {static_cast<std::byte*>(slot.value), slot.flat_size});
}

}  // namespace ros2
