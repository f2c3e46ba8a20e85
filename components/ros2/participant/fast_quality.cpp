// SPDX-License-Identifier: Apache-2.0
#include "fast_quality.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <limits>

namespace ros2 {
namespace {

using eprosima::fastrtps::Duration_t;
using std::chrono::nanoseconds;
constexpr std::int64_t kNanoseconds = 1'000'000'000;
/// How often readers that have not acknowledged are told what there is. Readers of Cyclone DDS that come
/// later miss a sample that is latched, since it is sent before they know its writer, and Fast DDS answers
/// their question only after this time. Nothing is sent when all have acknowledged.
const Duration_t kReminds{0, 100'000'000};

Duration_t duration_of(nanoseconds duration) {
  if (duration.count() <= 0) return eprosima::fastrtps::c_TimeInfinite;
  const std::int64_t seconds =
      std::min<std::int64_t>(duration.count() / kNanoseconds, std::numeric_limits<std::int32_t>::max() - 1);
  return {static_cast<std::int32_t>(seconds), static_cast<std::uint32_t>(duration.count() % kNanoseconds)};
}

nanoseconds from(const Duration_t& duration) {
  if (duration == eprosima::fastrtps::c_TimeInfinite) return nanoseconds(0);
  return nanoseconds(std::int64_t{duration.seconds} * kNanoseconds + duration.nanosec);
}

template <class Qos>
void fill(Qos& made, const segue::ros2::Quality& quality, const std::string& user_data) {
  made.reliability().kind = quality.reliability == segue::ros2::Reliability::Reliable
                                ? dds::RELIABLE_RELIABILITY_QOS
                                : dds::BEST_EFFORT_RELIABILITY_QOS;
  made.durability().kind = quality.durability == segue::ros2::Durability::Volatile
                               ? dds::VOLATILE_DURABILITY_QOS
                               : dds::TRANSIENT_LOCAL_DURABILITY_QOS;
  made.history().kind = quality.depth == 0 ? dds::KEEP_ALL_HISTORY_QOS : dds::KEEP_LAST_HISTORY_QOS;
  if (quality.depth > 0) {
    made.history().depth = static_cast<std::int32_t>(std::min(quality.depth, 1U << 30U));
    made.resource_limits().max_samples = std::max(made.resource_limits().max_samples, made.history().depth);
    made.resource_limits().max_samples_per_instance = made.resource_limits().max_samples;
  }
  made.deadline().period = duration_of(quality.deadline);
  made.lifespan().duration = duration_of(quality.lifespan);
  made.liveliness().kind = quality.liveliness == segue::ros2::Liveliness::Automatic
                               ? dds::AUTOMATIC_LIVELINESS_QOS
                               : dds::MANUAL_BY_TOPIC_LIVELINESS_QOS;
  made.liveliness().lease_duration = duration_of(quality.lease);
  made.liveliness().announcement_period = duration_of(quality.lease * 2 / 3);
  made.endpoint().history_memory_policy = eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  made.data_sharing().off();
  made.user_data().setValue({user_data.begin(), user_data.end()});
}

/// WriterQos and ReaderQos, which discovery tells.
template <class Qos>
segue::ros2::Quality told(const Qos& other) {
  segue::ros2::Quality quality;
  if (other.m_reliability.kind != dds::RELIABLE_RELIABILITY_QOS)
    quality.reliability = segue::ros2::Reliability::BestEffort;
  if (other.m_durability.kind != dds::VOLATILE_DURABILITY_QOS)
    quality.durability = segue::ros2::Durability::TransientLocal;
  quality.depth = 0;
  quality.deadline = from(other.m_deadline.period);
  quality.lifespan = from(other.m_lifespan.duration);
  if (other.m_liveliness.kind == dds::MANUAL_BY_TOPIC_LIVELINESS_QOS)
    quality.liveliness = segue::ros2::Liveliness::ManualByTopic;
  quality.lease = from(other.m_liveliness.lease_duration);
  return quality;
}

template <class Qos>
std::string told_data(const Qos& other) {
  const auto& data = other.m_userData.data_vec();
  return {data.begin(), data.end()};
}

}  // namespace

dds::DataWriterQos writer_quality(const segue::ros2::Quality& quality, const std::string& user_data) {
  dds::DataWriterQos made;
  fill(made, quality, user_data);
  made.reliable_writer_qos().times.heartbeatPeriod = kReminds;
  return made;
}

dds::DataReaderQos reader_quality(const segue::ros2::Quality& quality, const std::string& user_data) {
  dds::DataReaderQos made;
  fill(made, quality, user_data);
  return made;
}

segue::ros2::Quality quality_of(const dds::WriterQos& quality) {
  return told(quality);
}
segue::ros2::Quality quality_of(const dds::ReaderQos& quality) {
  return told(quality);
}
std::string user_data_of(const dds::WriterQos& quality) {
  return told_data(quality);
}
std::string user_data_of(const dds::ReaderQos& quality) {
  return told_data(quality);
}

}  // namespace ros2
