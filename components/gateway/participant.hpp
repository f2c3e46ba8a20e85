// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <dds/dds.h>

#include <cstdint>
#include <string>
#include <vector>

/// The one DDS participant of this process.
namespace gateway {

/// Where samples travel. All link tasks of a process have the same settings.
struct Settings {
  std::int32_t domain = 0;           ///< 0 to 232
  std::string interface {};          ///< name or address; empty: Cyclone's choice
  std::vector<std::string> peers{};  ///< addresses or host names; empty: others are found by multicast

  friend bool operator==(const Settings&, const Settings&) = default;
};

/// The addresses in $SEGUE_PEERS, which a runtime gives to the processes of a robot on several hosts. The
/// later of two participants finds the earlier one, which then answers, so that only the later must know the
/// other's address.
std::vector<std::string> peers_of_process();

/// After this time without a sign of life a participant counts as gone, with all its endpoints.
inline constexpr int kLeaseSeconds = 4;

/// The configuration of Cyclone DDS for these settings. Nothing else configures it; $CYCLONEDDS_URI is not
/// read.
std::string configuration(const Settings& settings);

/// The participant, which the first call creates and the end of the process deletes. InvalidArgument for
/// settings that are not settings, InvalidState where the first call had other settings, Unavailable with
/// Cyclone's own words where it cannot be created; a later call tries again. Any thread; may block for
/// seconds where names of peers must be resolved.
segue::Result<dds_entity_t> participant(const Settings& settings);

/// "topic: the message of the return code".
segue::Error dds_error(const std::string& what, dds_return_t code);

/// The number of writers, or of readers, that have the topic but another type. Asks for the list of all
/// endpoints, so it is for people, not for updates.
std::uint64_t count_other_types(dds_entity_t participant, const std::string& topic, const std::string& type,
                                bool writers);

}  // namespace gateway
