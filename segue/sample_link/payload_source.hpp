// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/sample_link/sample_form.hpp>
#include <segue/sample_link/shared_pools.hpp>
#include <segue/task/sample.hpp>
#include <segue/type/type_info.hpp>

#include <cstdint>
#include <memory>
#include <optional>

namespace segue::sample_link {

/// A reference to the payload of a sample: to a slot whose value lies in the pool, or to a block with a copy.
struct Payload {
  task::SampleSlot* slot = nullptr;  ///< retained
  std::uint64_t offset = RingEntry::kNoPayload;
  std::uint64_t size = 0;
};

/// Puts the samples of one output port into the payload pool, once for all its connections. A sample that
/// lies there already is only referenced.
class PayloadSource {
 public:
  /// `info`: the type of the port; nullptr where it is of any type.
  PayloadSource(std::shared_ptr<PayloadPool> pool, const type::TypeInfo* info);
  ~PayloadSource();
  PayloadSource(const PayloadSource&) = delete;
  PayloadSource& operator=(const PayloadSource&) = delete;

  /// A reference to the payload; nullopt where the pool is full. The writer only; real-time safe.
  std::optional<Payload> take(task::SampleSlot& sample) noexcept;
  /// A reference to a payload that this sample alone uses, so no copy is shared among connections; nullopt
  /// where the pool is full. Any thread; real-time safe.
  std::optional<Payload> take_apart(task::SampleSlot& sample) const noexcept;
  /// Gives a reference back. Any thread; real-time safe.
  void give_back(const Payload& payload) const noexcept;

 private:
  [[nodiscard]] std::size_t size_of(const task::SampleSlot& sample) const noexcept;
  [[nodiscard]] std::optional<Payload> in_place(task::SampleSlot& sample) const noexcept;
  [[nodiscard]] std::optional<Payload> written(const task::SampleSlot& sample) const noexcept;

  const std::shared_ptr<PayloadPool> pool_;
  const type::TypeInfo* const info_;
  const SampleForm form_;
  std::uint64_t newest_ = 0;  ///< writer only: sequence of the sample that block_ holds
  Payload block_;
};

}  // namespace segue::sample_link
