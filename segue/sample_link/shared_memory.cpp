// SPDX-License-Identifier: Apache-2.0
#include <segue/sample_link/payload_source.hpp>
#include <segue/sample_link/shared_state.hpp>

#include <sys/random.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace segue::sample_link {

namespace {

/// The only implementation; its destructor ends all connections.
class Memory final : public SharedMemory {
 public:
  explicit Memory(std::shared_ptr<SharedState> state) : state_(std::move(state)) {}
  ~Memory() override { state_->forget_all(); }

  [[nodiscard]] Incarnation incarnation() const override { return state_->incarnation(); }
  [[nodiscard]] Result<MemoryOffer> offer() const override {
    state_->payload()->restore_header(state_->incarnation());
    state_->control()->restore_header(state_->incarnation());
    MemoryOffer offer{state_->incarnation(), state_->payload()->descriptor().duplicate(),
                      state_->control()->descriptor().duplicate()};
    if (offer.payload.valid() && offer.control.valid()) return offer;
    return fail(ErrorCode::ResourceExhausted,
                std::string("no file descriptor is left to offer shared memory: ") + std::strerror(errno));
  }
  Result<void> admit(const MemoryOffer& peer) override {
    if (knows(peer.incarnation)) return {};
    auto mapped = PeerMemory::map(peer);
    if (!mapped) return std::move(mapped.error());
    state_->add_peer(std::move(*mapped));
    return {};
  }
  [[nodiscard]] bool knows(Incarnation peer) const override { return state_->peer(peer) != nullptr; }
  void forget(Incarnation peer) override { state_->forget(peer); }
  [[nodiscard]] MemoryUsage usage() const override { return state_->usage(); }
  [[nodiscard]] const std::shared_ptr<SharedState>& state() const { return state_; }

 private:
  std::shared_ptr<SharedState> state_;
};

Result<Incarnation> random_incarnation() {
  Incarnation random = 0;
  while (random == 0) {
    if (getrandom(&random, sizeof(random), 0) != static_cast<ssize_t>(sizeof(random)) && errno != EINTR)
      return fail(ErrorCode::IoError,
                  std::string("the system has no random number: ") + std::strerror(errno));
  }
  return random;
}

}  // namespace

Result<std::shared_ptr<SharedMemory>> SharedMemory::create(const SharedMemoryOptions& options) {
  auto incarnation = random_incarnation();
  if (!incarnation) return std::move(incarnation.error());
  if (options.prefault > options.payload) {
    return fail(ErrorCode::InvalidArgument, "cannot prefault " + std::to_string(options.prefault) +
                                                " bytes of a payload pool of " +
                                                std::to_string(options.payload));
  }
  auto payload = PayloadPool::create(*incarnation, options.payload, options.prefault);
  if (!payload) return std::move(payload.error());
  auto control = ControlPool::create(*incarnation, options.control);
  if (!control) return std::move(control.error());
  auto state = std::make_shared<SharedState>(*incarnation, std::move(*payload), std::move(*control));
  return std::shared_ptr<SharedMemory>(std::make_shared<Memory>(std::move(state)));
}

/// The cast is safe because create() makes every SharedMemory there is.
std::shared_ptr<SharedState> SharedState::of(const SharedMemory& memory) {
  return static_cast<const Memory&>(memory).state();
}

void SharedState::add_peer(std::shared_ptr<const PeerMemory> peer) {
  const Lock lock(mutex_);
  const Incarnation incarnation = peer->incarnation();
  peers_.emplace(incarnation, std::move(peer));
}

std::shared_ptr<const PeerMemory> SharedState::peer(Incarnation incarnation) const {
  const Lock lock(mutex_);
  const auto found = peers_.find(incarnation);
  return found == peers_.end() ? nullptr : found->second;
}

SharedState::Endpoints SharedState::snapshot(Endpoints SharedState::*which) const {
  const Lock lock(mutex_);
  return this->*which;
}

void SharedState::forget(Incarnation incarnation) {
  std::shared_ptr<const PeerMemory> peer;
  {
    const Lock lock(mutex_);
    const auto found = peers_.find(incarnation);
    if (found == peers_.end()) return;
    peer = std::move(found->second);
    peers_.erase(found);
  }
  for (const auto some : {&SharedState::connected_, &SharedState::ended_}) {
    for (const auto& endpoint : snapshot(some)) {
      if (endpoint->peer() == incarnation) endpoint->abandon();
    }
  }
  drop_ended();
}

void SharedState::forget_all() {
  std::vector<Incarnation> known;
  {
    const Lock lock(mutex_);
    for (const auto& [incarnation, peer] : peers_)
      known.push_back(incarnation);
  }
  for (const Incarnation incarnation : known)
    forget(incarnation);
}

Result<void> SharedState::keep(std::shared_ptr<RegisteredEndpoint> endpoint) {
  const Lock lock(mutex_);
  if (!peers_.contains(endpoint->peer())) {
    return fail(ErrorCode::NotFound,
                "the memory of the other process has not been admitted, or has been forgotten meanwhile");
  }
  connected_.push_back(std::move(endpoint));
  return {};
}

void SharedState::end(const RegisteredEndpoint& endpoint) {
  {
    const Lock lock(mutex_);
    const auto found = std::ranges::find(connected_, &endpoint, &std::shared_ptr<RegisteredEndpoint>::get);
    if (found != connected_.end()) {
      ended_.push_back(std::move(*found));
      connected_.erase(found);
    }
  }
  drop_ended();
}

void SharedState::drop_ended() {
  for (const auto& endpoint : snapshot(&SharedState::ended_)) {
    if (!endpoint->reclaim_rest()) continue;
    const Lock lock(mutex_);
    std::erase(ended_, endpoint);
  }
  const Lock lock(mutex_);
  std::erase_if(sources_, [](const auto& source) { return source.second.expired(); });
}

void SharedState::release(const InputPlace& place) {
  for (const auto some : {&SharedState::connected_, &SharedState::ended_}) {
    for (const auto& endpoint : snapshot(some))
      endpoint->release(place);
  }
  drop_ended();
}

std::size_t SharedState::in_flight(const task::OutputPortBase& port) const {
  std::size_t count = 0;
  for (const auto& endpoint : snapshot(&SharedState::ended_))
    count += endpoint->in_flight(port);
  return count;
}

std::shared_ptr<PayloadSource> SharedState::source_of(const task::OutputPortBase& port) {
  const Lock lock(mutex_);
  std::weak_ptr<PayloadSource>& known = sources_[port.number()];
  std::shared_ptr<PayloadSource> source = known.lock();
  if (source) return source;
  source = std::make_shared<PayloadSource>(payload_, port.type());
  known = source;
  return source;
}

MemoryUsage SharedState::usage() {
  drop_ended();
  MemoryUsage usage;
  usage.payload_used = payload_->blocks().used();
  usage.payload_touched = payload_->blocks().cut();
  usage.control_used = control_->blocks().used();
  const Lock lock(mutex_);
  usage.connections = connected_.size();
  usage.peers = peers_.size();
  return usage;
}

}  // namespace segue::sample_link
