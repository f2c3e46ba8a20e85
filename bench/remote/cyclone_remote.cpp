// SPDX-License-Identifier: Apache-2.0
#include <components/gateway/participant.hpp>

#include "../process/cyclone_peer.hpp"
#include "remote.hpp"

#include <dds/dds.h>

#include <atomic>
#include <cstdlib>
#include <vector>

#include <unistd.h>

namespace bench {
namespace {

constexpr std::int32_t kCycloneDomain = 79;

/// A participant with the topic, as the gateway's are configured.
struct Joined {
  Joined(const Route& route, const Place& mine) {
    enter(mine);
    const auto made =
        gateway::participant({kCycloneDomain, mine.address, {route.writer.address, route.reader.address}});
    if (!made) std::abort();
    participant = *made;
    const std::string name = "bench_" + std::to_string(::getpgrp()) + "_" + std::to_string(route.run);
    topic = ::dds_create_topic(participant, &bench_dds_Sample_desc, name.c_str(), nullptr, nullptr);
    quality = ::dds_create_qos();
    ::dds_qset_reliability(quality, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
    ::dds_qset_history(quality, DDS_HISTORY_KEEP_ALL, DDS_LENGTH_UNLIMITED);
  }
  dds_entity_t participant;
  dds_entity_t topic;
  dds_qos_t* quality;
};

class CycloneWriter final : public Writer {
 public:
  CycloneWriter(const Route& route, std::size_t bytes)
      : joined_(route, route.writer),
        data_(bytes - sizeof(Stamp)),
        writer_(::dds_create_writer(joined_.participant, joined_.topic, joined_.quality, nullptr)) {}
  bool send(std::uint64_t number) override { return write_cyclone(writer_, data_, number); }

 private:
  Joined joined_;
  std::vector<std::uint8_t> data_;
  dds_entity_t writer_;
};

struct Listening {
  Board& board;
  std::atomic<bool> ended{false};
};

void heard(dds_entity_t reader, void* self) {
  auto& listening = *static_cast<Listening*>(self);
  if (!note_cyclone(reader, listening.board)) return;
  listening.ended = true;
  listening.ended.notify_one();
}

class RemoteCyclone final : public Transport {
 public:
  RemoteCyclone(Route route, CycloneReader way) : route_(std::move(route)), way_(way) {}
  [[nodiscard]] std::string name() const override {
    return way_ == CycloneReader::WaitSet ? "Cyclone DDS, wait set" : "Cyclone DDS, listener";
  }
  [[nodiscard]] bool carries(std::size_t) const override { return true; }
  std::unique_ptr<Writer> open(const End& end) override {
    return std::make_unique<CycloneWriter>(route_, end.bytes);
  }
  void read(const End& end) override {
    const Joined joined(route_, route_.reader);
    if (way_ == CycloneReader::Listener) return listen(joined, end);
    const dds_entity_t reader =
        ::dds_create_reader(joined.participant, joined.topic, joined.quality, nullptr);
    read_cyclone(joined.participant, reader, end.board);
  }

 private:
  static void listen(const Joined& joined, const End& end) {
    Listening listening{end.board};
    dds_listener_t* listener = ::dds_create_listener(&listening);
    ::dds_lset_data_available(listener, &heard);
    ::dds_create_reader(joined.participant, joined.topic, joined.quality, listener);
    listening.ended.wait(false);
  }
  Route route_;
  CycloneReader way_;
};

}  // namespace

std::unique_ptr<Transport> make_remote_cyclone(const Route& route, CycloneReader reader) {
  return std::make_unique<RemoteCyclone>(route, reader);
}

}  // namespace bench
