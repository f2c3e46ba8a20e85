// SPDX-License-Identifier: Apache-2.0
#include "iceoryx_peer.hpp"
#include "transport.hpp"

#include <cstring>

namespace bench {
namespace {

class IceoryxWriter final : public Writer {
 public:
  explicit IceoryxWriter(std::size_t bytes) : bytes_(static_cast<std::uint32_t>(bytes)) {}
  bool send(std::uint64_t number) override {
    bool sent = false;
    publisher_.loan(bytes_).and_then([&](void* sample) {
      const Stamp stamp{clock_ns(), number};
      std::memcpy(sample, &stamp, sizeof stamp);
      publisher_.publish(sample);
      sent = true;
    });
    return sent;
  }

 private:
  std::uint32_t bytes_;
  iox::popo::UntypedPublisher publisher_{iceoryx_topic("hop")};
};

class Iceoryx final : public Transport {
 public:
  [[nodiscard]] std::string name() const override { return "iceoryx (WaitSet, loaned)"; }
  [[nodiscard]] bool carries(std::size_t) const override { return true; }
  std::unique_ptr<Writer> open(const End& end) override {
    join_iceoryx("bench-writer");
    return std::make_unique<IceoryxWriter>(end.bytes);
  }
  void read(const End& end) override {
    join_iceoryx("bench-reader");
    iox::popo::UntypedSubscriber subscriber(iceoryx_topic("hop"), iceoryx_queue(16));
    iox::popo::WaitSet<> waiting;
    if (waiting.attachState(subscriber, iox::popo::SubscriberState::HAS_DATA).has_error()) return;
    Stamp stamp;
    while (stamp.number != kLast) {
      waiting.wait();
      while (take(subscriber, stamp))
        end.board.arrive(stamp);
    }
  }

 private:
  static bool take(iox::popo::UntypedSubscriber& subscriber, Stamp& stamp) {
    bool taken = false;
    subscriber.take().and_then([&](const void* sample) {
      std::memcpy(&stamp, sample, sizeof stamp);
      subscriber.release(sample);
      taken = true;
    });
    return taken;
  }
};

}  // namespace

std::unique_ptr<Transport> make_iceoryx() {
  return std::make_unique<Iceoryx>();
}

}  // namespace bench
