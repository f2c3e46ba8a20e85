// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../participant/opaque_type.hpp"

#include <segue/ros2/message_codec.hpp>
#include <segue/task/sample.hpp>
#include <segue/type/cdr_flat.hpp>
#include <segue/type/cdr_object.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace ros2 {

/// A sample as CDR, encoded from where it lies. Nodes of ROS 2 do not send what exceeds a bound of its
/// message.
class SampleSource final : public MessageSource {
 public:
  SampleSource(const segue::ros2::MessageCodec& message, const segue::task::SampleSlot& sample)
      : type_(message.info()), bounds_(message.bounds()), sample_(sample), size_(encoded_size()) {}
  [[nodiscard]] std::size_t size() const noexcept override { return size_; }
  bool write(std::span<std::byte> bytes) const noexcept override {
    return encode(bytes) && (!bounds_.any() || bounds_.kept_by(bytes));
  }

 private:
  bool encode(std::span<std::byte> bytes) const noexcept {
    return sample_.flat_size > 0 ? segue::type::flat_to_cdr(type_, sample_.flat(), bytes)
                                 : segue::type::write_cdr(type_, sample_.value, bytes).has_value();
  }
  [[nodiscard]] std::size_t encoded_size() const noexcept {
    return sample_.flat_size > 0 ? segue::type::cdr_size_of_flat(type_, sample_.flat())
                                 : segue::type::cdr_size(type_, sample_.value);
  }
  const segue::type::TypeInfo& type_;
  const segue::ros2::MessageBounds& bounds_;
  const segue::task::SampleSlot& sample_;
  const std::size_t size_;
};

/// Empty where it cannot be sent.
inline std::vector<std::byte> cdr_of(const segue::ros2::MessageCodec& message,
                                     const segue::task::SampleSlot& sample) {
  if (sample.value == nullptr) return {};
  const SampleSource source(message, sample);
  std::vector<std::byte> bytes(source.size());
  if (!source.write(bytes)) bytes.clear();
  return bytes;
}

}  // namespace ros2
