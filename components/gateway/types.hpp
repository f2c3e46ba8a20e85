// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/describe.hpp>

#include <cstdint>

namespace gateway {

/// All counted since the task was configured. sent + refused is the number of samples that were taken from
/// `in`.
struct SenderStatistics {
  std::uint64_t sent = 0;  ///< samples that Cyclone DDS took
  std::uint64_t refused =
      0;                    ///< samples that could not be sent: readers are too slow, or the sample too large
  std::uint64_t lost = 0;   ///< of those sent: nobody was there, or a reader left before it acknowledged them
  std::uint64_t bytes = 0;  ///< of those sent, as CDR
  std::uint64_t unacknowledged = 0;  ///< of those sent: held until all readers have acknowledged them
  std::uint64_t matched = 0;         ///< Receivers and other readers now
  std::uint64_t mismatched = 0;      ///< readers now that have the topic but another type
};

/// All counted since the task was configured. received + corrupt + lost is the number of samples that a
/// Sender sent, from the first sample on that arrived, be they lost here or there.
struct ReceiverStatistics {
  std::uint64_t received = 0;    ///< samples that arrived whole
  std::uint64_t refused = 0;     ///< of those received: a connection of `out` had no room
  std::uint64_t lost = 0;        ///< samples that were overwritten before they arrived, or before start
  std::uint64_t corrupt = 0;     ///< messages that are not samples of the type
  std::uint64_t bytes = 0;       ///< of those received, as CDR
  std::uint64_t matched = 0;     ///< Senders and other writers now
  std::uint64_t mismatched = 0;  ///< writers now that have the topic but another type
};

SEGUE_TYPE(SenderStatistics, sent, refused, lost, bytes, unacknowledged, matched, mismatched)
SEGUE_TYPE(ReceiverStatistics, received, refused, lost, corrupt, bytes, matched, mismatched)

}  // namespace gateway
