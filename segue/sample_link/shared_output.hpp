// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/sample_link/lasting.hpp>
#include <segue/sample_link/payload_source.hpp>
#include <segue/sample_link/shared_ring.hpp>
#include <segue/sample_link/shared_state.hpp>
#include <segue/task/channel.hpp>
#include <segue/task/port.hpp>

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace segue::sample_link {

/// The writer's endpoint of a connection between processes. It records which entries are lent to the reader
/// in private memory, where the reader cannot corrupt it. Lock order: `mutex_`, then attach_mutex_ of the
/// output port, then the mutex of SharedState. The writing task takes none of them.
class SharedOutput final : public RegisteredEndpoint,
                           public task::WriterEnd,
                           public std::enable_shared_from_this<SharedOutput> {
 public:
  /// `ring`: the checked address of the ring in the mapping of the reader's memory.
  SharedOutput(std::shared_ptr<SharedState> state, std::shared_ptr<const PeerMemory> reader, std::byte* ring,
               const InputPlace& place, task::OutputPortBase& port, const Policy& policy,
               task::CommitGatePtr gate);
  Result<void> attach();

  bool push(task::SampleSlot& sample) noexcept override;
  [[nodiscard]] std::size_t capacity() const override;
  [[nodiscard]] bool same_as(const WriterEnd& other) const override;

  void disconnect() override;
  [[nodiscard]] bool connected() const override;
  [[nodiscard]] Counters counters() const override;
  [[nodiscard]] Latency latency() const override { return {}; }
  [[nodiscard]] const Policy& policy() const override { return policy_; }
  [[nodiscard]] Incarnation peer() const override { return reader_->incarnation(); }
  [[nodiscard]] std::uint64_t corrupt() const override { return corrupt_.load(std::memory_order_relaxed); }
  [[nodiscard]] Damage damage(TimePoint now) override;
  void end_at(task::CommitGatePtr gate) override;
  void settle() override;
  [[nodiscard]] bool dormant() const override;
  [[nodiscard]] bool carries() const override;
  [[nodiscard]] bool owes_samples() const override { return false; }  // the reader's endpoint knows

  void abandon() override;
  bool reclaim_rest() override;
  [[nodiscard]] std::size_t in_flight(const task::OutputPortBase& port) const override;
  void release(const InputPlace& /*place*/) override {}

 private:
  /// The private record of an entry of the ring. U1: `payload` is written before `out` is set (release);
  /// whoever clears `out` by an exchange (acquire) owns the payload and gives it back, so that happens once.
  struct LentEntry {
    std::atomic<bool> out{false};
    Payload payload;
  };
  enum class Delivery { Taken, Refused };

  Result<void> attach_to_port();
  Delivery deliver(task::SampleSlot& sample) noexcept;
  void lend(std::size_t entry, const Payload& payload, std::uint64_t sequence, TimePoint written_at) noexcept;
  bool reclaim(std::size_t entry) noexcept;
  void reclaim_token(std::uint64_t token) noexcept;
  void collect(std::size_t most_words) noexcept;
  void collect_all() noexcept;
  [[nodiscard]] std::size_t count_lent() const noexcept;
  void show_last();
  void offer_last(task::SampleSlot& last) noexcept;
  void ring_reader() const noexcept;
  [[nodiscard]] bool anybody_there() const noexcept;
  void note_replaced(std::uint64_t token, std::uint64_t by) noexcept;
  [[nodiscard]] bool is_overwritten() const noexcept;
  [[nodiscard]] Counters shown_counters() const noexcept;

  const std::shared_ptr<SharedState> state_;
  const std::shared_ptr<const PeerMemory> reader_;
  task::OutputPortBase& port_;  ///< valid while attached
  const std::uint64_t port_number_;
  const Policy policy_;
  const std::string reader_port_;
  const bool untyped_;
  std::shared_ptr<PayloadSource> source_;  ///< reset when settled
  SharedRing ring_;
  std::size_t in_flight_before_;  ///< samples of the port that ended connections had not got back at first

  // Used by the writing task while attached; afterwards under mutex_ by reclaim_rest(). detach() separates
  // the two.
  std::unique_ptr<LentEntry[]> lent_;
  std::vector<std::uint32_t> free_;    ///< entries that are not lent
  std::size_t next_word_ = 0;          ///< of the returned bits, to be checked next
  std::vector<std::uint64_t> placed_;  ///< by place of the words: the token that was pushed there last
  KeptCount written_;
  KeptCount initial_;
  KeptCount dropped_;
  KeptCount overwritten_;
  KeptCount taken_back_;
  // Relaxed: one thread counts each, and damage() only compares them.
  std::atomic<std::uint64_t> pushed_{0};    ///< tokens that went into the words ...
  std::atomic<std::uint64_t> replaced_{0};  ///< ... and those that were pushed out of them
  std::atomic<std::uint64_t> corrupt_{0};

  mutable Mutex mutex_;  ///< guards the members below
  bool attached_ SEGUE_GUARDED_BY(mutex_) = false;
  bool abandoned_ SEGUE_GUARDED_BY(mutex_) = false;
  task::CommitGatePtr gate_ SEGUE_GUARDED_BY(mutex_);  ///< nullptr: it carries samples already
  task::CommitGatePtr end_ SEGUE_GUARDED_BY(mutex_);   ///< the gate with which it ends
  Counters final_ SEGUE_GUARDED_BY(mutex_);
  Lasting wrong_ SEGUE_GUARDED_BY(mutex_);  ///< the ring is not as this side keeps it
};

}  // namespace segue::sample_link
