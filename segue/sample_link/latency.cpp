// SPDX-License-Identifier: Apache-2.0
#include <segue/sample_link/latency.hpp>

#include <algorithm>

namespace segue::sample_link {

Latency in_series(const Latency& first, const Latency& second) {
  const std::uint64_t measured = std::min(first.measured, second.measured);
  if (measured == 0) return {};
  return {measured, first.mean + second.mean, first.worst + second.worst, first.p99 + second.p99};
}

void LatencyRecorder::add(TimePoint written_at, TimePoint now) noexcept {
  const std::int64_t begin = written_at.time_since_epoch().count();
  if (begin < since_.load(std::memory_order_relaxed) || written_at > now) return;
  const std::int64_t took = (now - written_at).count();
  total_.store(total_.load(std::memory_order_relaxed) + static_cast<std::uint64_t>(took),
               std::memory_order_relaxed);
  histogram_.add(now - written_at);
  if (took > worst_.load(std::memory_order_relaxed)) worst_.store(took, std::memory_order_relaxed);
  measured_.store(measured_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

Latency LatencyRecorder::read() const noexcept {
  const std::uint64_t measured = measured_.load(std::memory_order_relaxed);
  if (measured == 0) return {};
  const Duration mean(static_cast<std::int64_t>(total_.load(std::memory_order_relaxed) / measured));
  const Duration worst(worst_.load(std::memory_order_relaxed));
  const Duration p99 = histogram_.read().quantile(0.99);
  return {measured, std::min(mean, worst), worst,
          std::min(p99, worst)};  // the total may have one sample more
}

}  // namespace segue::sample_link
