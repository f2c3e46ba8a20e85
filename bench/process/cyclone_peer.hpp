// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dds/dds.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "board.hpp"
#include "sample.h"

namespace bench {

/// Cyclone DDS over UDP of this computer alone.
class CycloneDomain {
 public:
  CycloneDomain()
      : domain_(::dds_create_domain(
            kDomain,
            "<CycloneDDS><Domain Id=\"any\"><General><Interfaces><NetworkInterface name=\"lo\"/></Interfaces>"
            "<AllowMulticast>false</AllowMulticast></General><Discovery><Peers><Peer "
            "Address=\"127.0.0.1\"/></Peers><ParticipantIndex>auto</ParticipantIndex></Discovery>"
            "</Domain></CycloneDDS>")),
        participant_(::dds_create_participant(kDomain, nullptr, nullptr)) {}
  ~CycloneDomain() { ::dds_delete(domain_); }
  CycloneDomain(const CycloneDomain&) = delete;
  CycloneDomain& operator=(const CycloneDomain&) = delete;

  [[nodiscard]] dds_entity_t participant() const { return participant_; }
  [[nodiscard]] dds_entity_t topic(const std::string& name) const {
    return ::dds_create_topic(participant_, &bench_dds_Sample_desc, name.c_str(), nullptr, nullptr);
  }

 private:
  static constexpr dds_domainid_t kDomain = 77;
  dds_entity_t domain_;
  dds_entity_t participant_;
};

/// Reliable: no sample is lost while at most eight are in flight.
inline dds_qos_t* cyclone_quality() {
  dds_qos_t* quality = ::dds_create_qos();
  ::dds_qset_reliability(quality, DDS_RELIABILITY_RELIABLE, DDS_SECS(10));
  ::dds_qset_history(quality, DDS_HISTORY_KEEP_LAST, 8);
  return quality;
}

inline dds_entity_t make_cyclone_writer(const CycloneDomain& domain, dds_entity_t topic) {
  dds_qos_t* quality = cyclone_quality();
  const dds_entity_t writer = ::dds_create_writer(domain.participant(), topic, quality, nullptr);
  ::dds_delete_qos(quality);
  return writer;
}

inline dds_entity_t make_cyclone_reader(const CycloneDomain& domain, dds_entity_t topic) {
  dds_qos_t* quality = cyclone_quality();
  const dds_entity_t reader = ::dds_create_reader(domain.participant(), topic, quality, nullptr);
  ::dds_delete_qos(quality);
  return reader;
}

/// Writes a sample with these data.
inline bool write_cyclone(dds_entity_t writer, std::vector<std::uint8_t>& data, std::uint64_t number) {
  bench_dds_Sample sample{};
  sample.sent_ns = clock_ns();
  sample.number = number;
  sample.data._buffer = data.data();
  sample.data._length = sample.data._maximum = static_cast<std::uint32_t>(data.size());
  return ::dds_write(writer, &sample) == DDS_RETCODE_OK;
}

struct TakenCyclone {
  bool any = false;              ///< whether there was something
  std::optional<Stamp> stamp{};  ///< of a sample; nothing where it only tells of an end
};

/// Takes the next sample, without a copy of its data beyond the one that Cyclone makes.
inline TakenCyclone take_cyclone(dds_entity_t reader) {
  void* samples[1] = {nullptr};
  dds_sample_info_t info[1];
  const dds_return_t taken = ::dds_take(reader, samples, info, 1, 1);
  if (taken <= 0) return {};
  TakenCyclone result{true};
  if (info[0].valid_data) {
    const auto* sample = static_cast<const bench_dds_Sample*>(samples[0]);
    result.stamp = Stamp{sample->sent_ns, sample->number};
  }
  ::dds_return_loan(reader, samples, taken);
  return result;
}

/// Records all samples that are there; true where the last one was among them.
inline bool note_cyclone(dds_entity_t reader, Board& board) {
  bool ended = false;
  for (auto taken = take_cyclone(reader); taken.any; taken = take_cyclone(reader)) {
    if (!taken.stamp) continue;
    board.arrive(*taken.stamp);
    ended = ended || taken.stamp->number == kLast;
  }
  return ended;
}

/// Waits for samples and records them until the last one.
inline void read_cyclone(dds_entity_t participant, dds_entity_t reader, Board& board) {
  const dds_entity_t waiting = ::dds_create_waitset(participant);
  const dds_entity_t condition = ::dds_create_readcondition(reader, DDS_ANY_STATE);
  ::dds_waitset_attach(waiting, condition, 0);
  do
    ::dds_waitset_wait(waiting, nullptr, 0, DDS_INFINITY);
  while (!note_cyclone(reader, board));
}

}  // namespace bench
