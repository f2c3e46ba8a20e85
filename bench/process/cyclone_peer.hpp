// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dds/dds.h>

#include <cstdint>
#include <string>

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

/// The next sample's stamp, without a copy of its data beyond the one that Cyclone makes.
inline bool take_cyclone(dds_entity_t reader, std::int64_t& sent_ns, std::uint64_t& number) {
  void* samples[1] = {nullptr};
  dds_sample_info_t info[1];
  const dds_return_t taken = ::dds_take(reader, samples, info, 1, 1);
  if (taken <= 0) return false;
  const bool valid = info[0].valid_data;
  if (valid) {
    const auto* sample = static_cast<const bench_dds_Sample*>(samples[0]);
    sent_ns = sample->sent_ns;
    number = sample->number;
  }
  ::dds_return_loan(reader, samples, taken);
  return valid;
}

}  // namespace bench
