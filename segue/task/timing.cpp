// SPDX-License-Identifier: Apache-2.0
#include <segue/task/executor.hpp>
#include <segue/task/timing_recorder.hpp>

#include <algorithm>
#include <cstdlib>

namespace segue::task::detail {

void TimingRecorder::reset(const Executor& executor) {
  for (Count* count : {&cycles_, &missed_, &last_, &total_, &worst_, &latency_total_, &latency_worst_,
                       &deviation_total_, &previous_begin_}) {
    count->store(0, std::memory_order_relaxed);
  }
  updates_.reset();
  latencies_.reset();
  const Executor::Usage usage = executor.usage();
  cpu_at_start_.store(usage.cpu.count(), std::memory_order_relaxed);
  busy_at_start_.store(usage.busy.count(), std::memory_order_relaxed);
}

[[gnu::hot]] void TimingRecorder::record(TimePoint due, TimePoint begin, TimePoint end, Duration period,
                                         std::uint64_t missed) noexcept {
  const std::int64_t duration = (end - begin).count();
  const std::int64_t latency = std::max<std::int64_t>((begin - due).count(), 0);
  const std::int64_t begin_count = begin.time_since_epoch().count();
  if (period > Duration::zero() && cycles_.load(std::memory_order_relaxed) > 0) {
    const std::int64_t between = begin_count - previous_begin_.load(std::memory_order_relaxed);
    add(deviation_total_, std::abs(between - period.count()));
  }
  previous_begin_.store(begin_count, std::memory_order_relaxed);
  last_.store(duration, std::memory_order_relaxed);
  add(missed_, static_cast<std::int64_t>(missed));
  add(total_, duration);
  raise(worst_, duration);
  add(latency_total_, latency);
  raise(latency_worst_, latency);
  updates_.add(Duration(duration));
  latencies_.add(Duration(latency));
  add(cycles_, 1);
}

Timing TimingRecorder::timing(const Executor& executor) const {
  Timing timing;
  const std::int64_t cycles = cycles_.load(std::memory_order_relaxed);
  timing.cycles = static_cast<std::uint64_t>(cycles);
  timing.missed = static_cast<std::uint64_t>(missed_.load(std::memory_order_relaxed));
  timing.last = Duration(last_.load(std::memory_order_relaxed));
  timing.worst = Duration(worst_.load(std::memory_order_relaxed));
  timing.latency_worst = Duration(latency_worst_.load(std::memory_order_relaxed));
  const std::int64_t total = total_.load(std::memory_order_relaxed);
  if (cycles > 0) {
    timing.mean = Duration(total / cycles);
    timing.latency_mean = Duration(latency_total_.load(std::memory_order_relaxed) / cycles);
  }
  if (cycles > 1) timing.jitter = Duration(deviation_total_.load(std::memory_order_relaxed) / (cycles - 1));
  const Executor::Usage usage = executor.usage();
  const auto cpu = static_cast<double>(usage.cpu.count() - cpu_at_start_.load(std::memory_order_relaxed));
  const auto busy = static_cast<double>(usage.busy.count() - busy_at_start_.load(std::memory_order_relaxed));
  if (busy > 0) {
    const double share = std::clamp(cpu / busy, 0.0, 1.0);
    timing.cpu = Duration(static_cast<std::int64_t>(share * static_cast<double>(total)));
  }
  return timing;
}

}  // namespace segue::task::detail
