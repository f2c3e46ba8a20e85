// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace segue::ros2 {

enum class Reliability : std::uint8_t { Reliable, BestEffort };
enum class Durability : std::uint8_t { Volatile, TransientLocal };
enum class Liveliness : std::uint8_t { Automatic, ManualByTopic };

/// The quality of service of a publisher or a subscription, with the defaults of ROS 2
/// (rmw_qos_profile_default). Durations of zero are infinite.
struct Quality {
  Reliability reliability = Reliability::Reliable;
  Durability durability = Durability::Volatile;
  std::uint32_t depth = 10;  ///< the last samples that are kept; 0: all
  std::chrono::nanoseconds deadline{0};
  std::chrono::nanoseconds lifespan{0};
  Liveliness liveliness = Liveliness::Automatic;
  std::chrono::nanoseconds lease{0};
  friend bool operator==(const Quality&, const Quality&) = default;
};

/// "reliable" and "best_effort"; "volatile" and "transient_local"; "automatic" and "manual_by_topic".
/// InvalidArgument names those that there are.
Result<Reliability> parse_reliability(std::string_view text);
Result<Durability> parse_durability(std::string_view text);
Result<Liveliness> parse_liveliness(std::string_view text);
std::string_view to_string(Reliability reliability);
std::string_view to_string(Durability durability);
std::string_view to_string(Liveliness liveliness);

/// Why a subscription that requests one quality gets nothing from a publisher that offers the other (DDS 1.4,
/// 2.2.3): "reliability: best_effort is offered, reliable is requested". Empty: they match.
std::vector<std::string> mismatches(const Quality& offered, const Quality& requested);

}  // namespace segue::ros2
