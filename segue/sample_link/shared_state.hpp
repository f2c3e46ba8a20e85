// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/sample_link/shared_connection.hpp>
#include <segue/sample_link/shared_memory.hpp>
#include <segue/sample_link/shared_pools.hpp>

#include <atomic>
#include <map>
#include <memory>
#include <vector>

namespace segue::sample_link {

class PayloadSource;

/// An endpoint as SharedState manages it.
class RegisteredEndpoint : public SharedEndpoint {
 public:
  /// Disconnects; the peer is dead and gives nothing back any more.
  virtual void abandon() = 0;
  /// Reclaims what the peer has given back since the endpoint ended. True: nothing is outstanding.
  virtual bool reclaim_rest() = 0;
  /// Samples of `port` that the reader still holds after this endpoint has ended.
  [[nodiscard]] virtual std::size_t in_flight(const task::OutputPortBase& port) const = 0;
  /// The peer will not touch the ring at this place any more.
  virtual void release(const InputPlace& place) = 0;
};

/// State shared by a SharedMemory and the endpoints of its connections; lives until the last of them is gone.
/// Any thread. Lock order: an endpoint may call this while it holds its own mutex, so this never calls an
/// endpoint while it holds `mutex_`; it works on copies of its lists instead.
class SharedState final {
 public:
  SharedState(Incarnation incarnation, std::shared_ptr<PayloadPool> payload,
              std::shared_ptr<ControlPool> control)
      : incarnation_(incarnation), payload_(std::move(payload)), control_(std::move(control)) {}
  static std::shared_ptr<SharedState> of(const SharedMemory& memory);

  [[nodiscard]] Incarnation incarnation() const { return incarnation_; }
  [[nodiscard]] const std::shared_ptr<PayloadPool>& payload() const { return payload_; }
  [[nodiscard]] const std::shared_ptr<ControlPool>& control() const { return control_; }
  std::uint64_t next_generation() { return generation_.fetch_add(1) + 1; }

  void add_peer(std::shared_ptr<const PeerMemory> peer);
  /// nullptr where the peer has not been admitted.
  [[nodiscard]] std::shared_ptr<const PeerMemory> peer(Incarnation incarnation) const;
  void forget(Incarnation incarnation);
  void forget_all();

  /// Keeps an endpoint until it has ended and nothing is outstanding. NotFound where its peer has been
  /// forgotten meanwhile.
  Result<void> keep(std::shared_ptr<RegisteredEndpoint> endpoint);
  /// Called by an endpoint that has ended.
  void end(const RegisteredEndpoint& endpoint);
  /// Drops the endpoints that have ended and to which nothing is outstanding.
  void drop_ended();
  void release(const InputPlace& place);
  /// Samples of a port that readers of ended endpoints still hold.
  [[nodiscard]] std::size_t in_flight(const task::OutputPortBase& port) const;
  /// The payload source that all shared connections of an output port use.
  std::shared_ptr<PayloadSource> source_of(const task::OutputPortBase& port);
  [[nodiscard]] MemoryUsage usage();

 private:
  using Endpoints = std::vector<std::shared_ptr<RegisteredEndpoint>>;
  [[nodiscard]] Endpoints snapshot(Endpoints SharedState::*which) const;

  const Incarnation incarnation_;
  const std::shared_ptr<PayloadPool> payload_;
  const std::shared_ptr<ControlPool> control_;
  std::atomic<std::uint64_t> generation_{0};  ///< of the last ring; numbers differ, and order nothing
  mutable Mutex mutex_;                       ///< guards the members below
  std::map<Incarnation, std::shared_ptr<const PeerMemory>> peers_ SEGUE_GUARDED_BY(mutex_);
  Endpoints connected_ SEGUE_GUARDED_BY(mutex_);
  Endpoints ended_ SEGUE_GUARDED_BY(mutex_);
  /// The sources, by port number: a source outlives its port until all readers have returned its samples, and
  /// another port may have got the address meanwhile.
  std::map<std::uint64_t, std::weak_ptr<PayloadSource>> sources_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::sample_link
