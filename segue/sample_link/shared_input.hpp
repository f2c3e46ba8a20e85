// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/sample_link/lasting.hpp>
#include <segue/sample_link/payload_source.hpp>
#include <segue/sample_link/shared_samples.hpp>
#include <segue/sample_link/shared_state.hpp>
#include <segue/task/channel.hpp>
#include <segue/task/port.hpp>
#include <segue/task/sample_pool.hpp>

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>

namespace segue::sample_link {

/// The reader's endpoint of a connection between processes. Lock order: listener_mutex_ of the input port,
/// then `mutex_`, then those of the doorbell, the executor and SharedState.
class SharedInput final : public RegisteredEndpoint,
                          public task::ReaderEnd,
                          public std::enable_shared_from_this<SharedInput> {
 public:
  SharedInput(std::shared_ptr<SharedState> state, std::shared_ptr<const PeerMemory> writer,
              std::shared_ptr<OwnedRing> ring, task::InputPortBase& port, const Policy& policy, bool untyped,
              task::CommitGatePtr gate);
  Result<void> open();
  [[nodiscard]] InputPlace place() const;

  task::SampleRef pull() noexcept override;
  [[nodiscard]] bool pending() const noexcept override { return (*ring_)->words().pending(); }
  [[nodiscard]] std::uint64_t number() const noexcept override { return number_; }
  void set_listener(task::SampleListener* listener) override;

  void disconnect() override;
  [[nodiscard]] bool connected() const override;
  [[nodiscard]] Counters counters() const override;
  [[nodiscard]] Latency latency() const override { return latency_.read(); }
  [[nodiscard]] const Policy& policy() const override { return policy_; }
  [[nodiscard]] Incarnation peer() const override { return writer_->incarnation(); }
  [[nodiscard]] std::uint64_t corrupt() const override;
  [[nodiscard]] Damage damage(TimePoint now) override;
  void end_at(task::CommitGatePtr gate) override;
  void settle() override;
  [[nodiscard]] bool dormant() const override;
  [[nodiscard]] bool carries() const override;
  [[nodiscard]] bool owes_samples() const override;

  void abandon() override;
  bool reclaim_rest() override;
  [[nodiscard]] std::size_t in_flight(const task::OutputPortBase& /*port*/) const override { return 0; }
  void release(const InputPlace& place) override;

 private:
  Result<void> keep();
  task::SampleRef accept(std::size_t entry, task::SampleSlot* spare) noexcept;
  [[nodiscard]] const void* find_value(std::uint64_t offset, std::uint64_t size) const noexcept;
  task::SampleRef decode(std::size_t entry, const void* bytes, std::size_t size, std::uint64_t sequence,
                         task::SampleSlot& spare) noexcept;
  task::SampleRef reject(std::size_t entry) noexcept;
  task::SampleRef reject_payload(std::size_t entry) noexcept;
  [[nodiscard]] Counters shown_counters() const noexcept SEGUE_REQUIRES(mutex_);
  [[nodiscard]] std::uint64_t count_corrupt() const noexcept;
  void take_line(task::Executor& runner) SEGUE_REQUIRES(mutex_);
  void give_line_back() SEGUE_REQUIRES(mutex_);
  [[nodiscard]] bool header_is_ours() const noexcept SEGUE_REQUIRES(mutex_);
  [[nodiscard]] bool is_overwritten() noexcept SEGUE_REQUIRES(mutex_);
  void wake_if_forgotten() noexcept SEGUE_REQUIRES(mutex_);

  const std::shared_ptr<SharedState> state_;
  const std::shared_ptr<const PeerMemory> writer_;
  task::InputPortBase& port_;  ///< valid while open
  const type::TypeInfo* const info_;
  const SampleForm form_;
  const bool decodes_;  ///< objects are read from samples in the flat layout
  const bool checked_;  ///< values are looked at before they are passed on
  const Policy policy_;
  const std::uint64_t number_ = task::next_connection_number();
  const std::uint64_t offset_;  ///< of the ring in the control pool
  const std::uint64_t generation_;
  const std::string port_name_;

  SharedSamples::Handle samples_;     ///< for samples that are read in place
  task::SamplePool::Handle decoded_;  ///< for objects
  LatencyRecorder latency_;
  std::uint64_t newest_read_ = 0;          ///< reader only: sequence of the newest sample
  KeptCount read_;                         ///< samples taken out of the ring and delivered, or too old
  std::atomic<std::uint64_t> corrupt_{0};  ///< invalid words and entries; relaxed: only counted
  std::atomic<std::uint64_t> invalid_{
      0};  ///< among them: bytes that are not a sample, which only the writer can write

  mutable Mutex mutex_;  ///< guards the members below
  /// Reset under the mutex, and only after detach(), so the reader's thread needs none.
  std::shared_ptr<OwnedRing> ring_;
  bool open_ SEGUE_GUARDED_BY(mutex_) = false;
  /// The writer's endpoint is closed: the place may be reused.
  bool released_ SEGUE_GUARDED_BY(mutex_) = false;
  std::uint64_t announced_ SEGUE_GUARDED_BY(mutex_) = 0;  ///< the word `doorbell` of the header
  Lasting overwritten_ SEGUE_GUARDED_BY(mutex_);          ///< the ring is not as this side keeps it
  std::uint64_t read_at_last_look_ SEGUE_GUARDED_BY(mutex_) = 0;
  std::shared_ptr<task::Doorbell> doorbell_ SEGUE_GUARDED_BY(mutex_);
  unsigned line_ SEGUE_GUARDED_BY(mutex_) = 0;
  task::CommitGatePtr gate_ SEGUE_GUARDED_BY(mutex_);  ///< nullptr: samples arrive already
  task::CommitGatePtr end_ SEGUE_GUARDED_BY(mutex_);   ///< the gate with which it ends
  Counters final_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::sample_link
