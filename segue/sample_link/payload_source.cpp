// SPDX-License-Identifier: Apache-2.0
#include <segue/sample_link/payload_source.hpp>
#include <segue/type/flat.hpp>

#include <cstring>

namespace segue::sample_link {

PayloadSource::PayloadSource(std::shared_ptr<PayloadPool> pool, const type::TypeInfo* info)
    : pool_(std::move(pool)), info_(info), form_(form_of(info)) {}

PayloadSource::~PayloadSource() {
  give_back(block_);
}

[[gnu::hot]] std::optional<Payload> PayloadSource::take(task::SampleSlot& sample) noexcept {
  if (auto payload = in_place(sample)) return payload;
  if (newest_ != sample.sequence || block_.offset == RingEntry::kNoPayload) {
    give_back(std::exchange(block_, {}));
    auto payload = written(sample);
    if (!payload) return std::nullopt;
    block_ = *payload;
    newest_ = sample.sequence;
  }
  pool_->blocks().retain(block_.offset);
  return block_;
}

std::optional<Payload> PayloadSource::take_apart(task::SampleSlot& sample) const noexcept {
  if (auto payload = in_place(sample)) return payload;
  return written(sample);
}

[[gnu::hot]] void PayloadSource::give_back(const Payload& payload) const noexcept {
  if (payload.slot != nullptr) {
    payload.slot->release();
  } else if (payload.offset != RingEntry::kNoPayload) {
    pool_->blocks().release(payload.offset);
  }
}

[[gnu::hot]] std::optional<Payload> PayloadSource::in_place(task::SampleSlot& sample) const noexcept {
  if (form_ == SampleForm::Untyped) return Payload{};
  const bool has_form = form_ == SampleForm::Raw || sample.flat_size > 0;
  const auto offset = has_form ? pool_->offset_of(sample.value) : std::nullopt;
  if (!offset) return std::nullopt;
  sample.retain();
  return Payload{&sample, *offset, size_of(sample)};
}

[[gnu::hot]] std::size_t PayloadSource::size_of(const task::SampleSlot& sample) const noexcept {
  if (form_ == SampleForm::Raw) return info_->size;
  return sample.flat_size > 0 ? sample.flat_size : type::flat_size(*info_, sample.value);
}

std::optional<Payload> PayloadSource::written(const task::SampleSlot& sample) const noexcept {
  const std::size_t size = size_of(sample);
  const std::uint64_t offset = pool_->blocks().allocate(std::max(size, info_->alignment));
  if (offset == BlockPool::kNone) return std::nullopt;
  std::byte* const bytes = pool_->at(offset);
  if (form_ == SampleForm::Raw || sample.flat_size > 0) {
    std::memcpy(bytes, sample.value, size);
  } else if (!type::write_flat(*info_, sample.value, {bytes, size})) {
    pool_->blocks().release(offset);
    return std::nullopt;
  }
  return Payload{nullptr, offset, size};
}

}  // namespace segue::sample_link
