// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/link/payload_source.hpp>
#include <segue/link/shared_ring.hpp>
#include <segue/link/shared_state.hpp>
#include <segue/task/channel.hpp>
#include <segue/task/port.hpp>

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace segue::link {

/// The writer's endpoint of a connection between processes. What it has given to the reader is written down
/// here, where the reader cannot spoil it.
class SharedOutput final : public RegisteredEndpoint,
                           public task::WriterEnd,
                           public std::enable_shared_from_this<SharedOutput> {
 public:
  /// `ring`: where it lies in the map of the reader's memory; checked.
  SharedOutput(std::shared_ptr<SharedState> state, std::shared_ptr<const PeerMemory> reader, std::byte* ring,
               const InputPlace& place, task::OutputPortBase& port, const Policy& policy);
  Result<void> attach();

  bool push(task::SampleSlot& sample) noexcept override;
  [[nodiscard]] std::size_t capacity() const override;
  [[nodiscard]] bool same_as(const WriterEnd& other) const override;

  void disconnect() override;
  [[nodiscard]] bool connected() const override;
  [[nodiscard]] Counters counters() const override;
  [[nodiscard]] const Policy& policy() const override { return policy_; }
  [[nodiscard]] Incarnation peer() const override { return reader_->incarnation(); }
  [[nodiscard]] std::uint64_t corrupt() const override { return corrupt_.load(std::memory_order_relaxed); }

  void abandon() override;
  bool settle() override;
  [[nodiscard]] std::size_t in_flight(const task::OutputPortBase& port) const override;
  void release(const InputPlace& /*place*/) override {}

 private:
  /// An entry of the ring. While `out`, the payload belongs to whoever clears that.
  struct LentEntry {
    std::atomic<bool> out{false};
    Payload payload;
  };
  enum class Delivery { Taken, Refused };

  Result<void> attach_to_port();
  Delivery deliver(task::SampleSlot& sample) noexcept;
  void lend(std::size_t entry, const Payload& payload, std::uint64_t sequence) noexcept;
  bool reclaim(std::size_t entry) noexcept;
  void reclaim_token(std::uint64_t token) noexcept;
  void collect(std::size_t most_words) noexcept;
  void collect_all() noexcept;
  [[nodiscard]] std::size_t count_lent() const noexcept;
  void offer_last(task::SampleSlot& last) noexcept;
  void ring_reader() const noexcept;
  [[nodiscard]] bool anybody_there() const noexcept;

  const std::shared_ptr<SharedState> state_;
  const std::shared_ptr<const PeerMemory> reader_;
  task::OutputPortBase& port_;  ///< valid while attached
  const Policy policy_;
  const std::string reader_port_;
  const bool untyped_;
  std::shared_ptr<PayloadSource> source_;  ///< until it has settled
  SharedRing ring_;
  std::size_t in_flight_before_;  ///< of earlier connections of the port, when this one was made

  // The writer's, and nobody's once it has ended.
  std::unique_ptr<LentEntry[]> lent_;
  std::vector<std::uint32_t> free_;  ///< entries that are not out
  std::size_t next_word_ = 0;        ///< of the returned bits, to be looked at
  std::atomic<std::uint64_t> corrupt_{0};

  mutable std::mutex mutex_;  ///< guards what follows
  bool attached_ = false;
  bool abandoned_ = false;
  Counters final_;
};

}  // namespace segue::link
