// SPDX-License-Identifier: Apache-2.0
#include "cyclone_peer.hpp"
#include "transport.hpp"

#include <vector>

namespace bench {
namespace {

class CycloneWriter final : public Writer {
 public:
  explicit CycloneWriter(std::size_t bytes) : data_(bytes - sizeof(Stamp)) {}
  bool send(std::uint64_t number) override {
    bench_dds_Sample sample{};
    sample.sent_ns = clock_ns();
    sample.number = number;
    sample.data._buffer = data_.data();
    sample.data._length = sample.data._maximum = static_cast<std::uint32_t>(data_.size());
    return ::dds_write(writer_, &sample) == DDS_RETCODE_OK;
  }

 private:
  std::vector<std::uint8_t> data_;
  CycloneDomain domain_;
  dds_entity_t writer_ = make_cyclone_writer(domain_, domain_.topic("hop"));
};

class Cyclone final : public Transport {
 public:
  [[nodiscard]] std::string name() const override { return "Cyclone DDS (UDP loopback, reliable)"; }
  [[nodiscard]] bool carries(std::size_t) const override { return true; }
  std::unique_ptr<Writer> open(const End& end) override { return std::make_unique<CycloneWriter>(end.bytes); }
  void read(const End& end) override {
    const CycloneDomain domain;
    const dds_entity_t reader = make_cyclone_reader(domain, domain.topic("hop"));
    const dds_entity_t waiting = ::dds_create_waitset(domain.participant());
    const dds_entity_t condition = ::dds_create_readcondition(reader, DDS_ANY_STATE);
    ::dds_waitset_attach(waiting, condition, 0);
    Stamp stamp;
    while (stamp.number != kLast) {
      ::dds_waitset_wait(waiting, nullptr, 0, DDS_INFINITY);
      while (take_cyclone(reader, stamp.sent_ns, stamp.number))
        end.board.arrive(stamp);
    }
  }
};

}  // namespace

std::unique_ptr<Transport> make_cyclone() {
  return std::make_unique<Cyclone>();
}

}  // namespace bench
