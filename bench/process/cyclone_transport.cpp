// SPDX-License-Identifier: Apache-2.0
#include "cyclone_peer.hpp"
#include "transport.hpp"

#include <vector>

namespace bench {
namespace {

class CycloneWriter final : public Writer {
 public:
  explicit CycloneWriter(std::size_t bytes) : data_(bytes - sizeof(Stamp)) {}
  bool send(std::uint64_t number) override { return write_cyclone(writer_, data_, number); }

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
    read_cyclone(domain.participant(), reader, end.board);
  }
};

}  // namespace

std::unique_ptr<Transport> make_cyclone() {
  return std::make_unique<Cyclone>();
}

}  // namespace bench
