// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/describe.hpp>

#include <cstdint>

namespace ros2 {

/// All counted since the task was configured.
struct PublisherStatistics {
  std::uint64_t sent = 0;  ///< samples that Fast DDS took
  std::uint64_t refused =
      0;  ///< samples that were not sent: a bound of the message is exceeded, or subscriptions are slow
  std::uint64_t bytes = 0;       ///< of those sent, as CDR
  std::uint64_t missed = 0;      ///< deadlines that were missed, and losses of liveliness
  std::uint32_t matched = 0;     ///< subscriptions now
  std::uint32_t mismatched = 0;  ///< subscriptions now that have the topic but get nothing from here
};

/// All counted since the task was configured.
struct SubscriptionStatistics {
  std::uint64_t received = 0;    ///< samples that arrived whole, and were for this task
  std::uint64_t early = 0;       ///< samples that came while the task did not run
  std::uint64_t refused = 0;     ///< of those received: a connection of `out` had no room
  std::uint64_t lost = 0;        ///< samples that were overwritten before they arrived, as Fast DDS tells
  std::uint64_t corrupt = 0;     ///< messages that are not samples of the type
  std::uint64_t bytes = 0;       ///< of those received, as CDR
  std::uint64_t missed = 0;      ///< deadlines that were missed, and losses of liveliness
  std::uint32_t matched = 0;     ///< publishers now
  std::uint32_t mismatched = 0;  ///< publishers now that have the topic but from which nothing comes
};

/// All counted since the task was configured.
struct ActionStatistics {
  std::uint64_t goals = 0;     ///< that were sent, or were to be
  std::uint64_t feedback = 0;  ///< of goals that were under way
  std::uint64_t corrupt = 0;   ///< messages that are not feedback or results of the action
  std::uint32_t servers = 0;   ///< now
};

SEGUE_TYPE(PublisherStatistics, sent, refused, bytes, missed, matched, mismatched)
SEGUE_TYPE(SubscriptionStatistics, received, early, refused, lost, corrupt, bytes, missed, matched,
           mismatched)
SEGUE_TYPE(ActionStatistics, goals, feedback, corrupt, servers)

}  // namespace ros2
