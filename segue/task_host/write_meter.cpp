// SPDX-License-Identifier: Apache-2.0
#include <segue/base/clock.hpp>
#include <segue/base/mutex.hpp>
#include <segue/task/channel.hpp>
#include <segue/task/port_access.hpp>
#include <segue/task_host/write_meter.hpp>
#include <segue/type/flat.hpp>
#include <segue/type/type_info.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

namespace segue::task_host::detail {

namespace {

/// Sums over all writes so far. Differences of two are those of the time between.
struct Sums {
  std::uint64_t samples = 0;
  std::uint64_t bytes = 0;
  std::uint64_t intervals = 0;
  double seconds = 0;
  double squares = 0;
};

/// The end of a connection that counts samples instead of passing them on. The writer is one thread, the
/// reader another.
///
/// Memory order: M1, a sequence lock: the writer makes `version_` odd before it changes the sums and even
/// after; a reader that sees another version after reading than before, or an odd one, reads again. The sums
/// are relaxed atomics between an acquire fence and a release store.
class Meter final : public task::WriterEnd {
 public:
  explicit Meter(task::OutputPortBase& port) : port_(port), info_(port.type()) {}

  bool push(task::SampleSlot& sample) noexcept override {
    const TimePoint now = monotonic_now();
    const std::uint64_t version = version_.load(std::memory_order_relaxed);
    version_.store(version + 1, std::memory_order_relaxed);
    std::atomic_thread_fence(std::memory_order_release);  // M1
    add(samples_, std::uint64_t{1});
    add(bytes_, static_cast<std::uint64_t>(size_of(sample)));
    if (last_ != TimePoint()) add_interval(std::chrono::duration<double>(now - last_).count());
    last_ = now;
    version_.store(version + 2, std::memory_order_release);  // M1
    return true;
  }

  void disconnect() override {
    const Lock lock(mutex_);
    if (std::exchange(attached_, false)) task::OutputPortAccess::detach(port_, *this);
  }
  [[nodiscard]] std::size_t capacity() const override { return 0; }
  [[nodiscard]] bool same_as(const WriterEnd& /*other*/) const override { return false; }

  [[nodiscard]] Sums sums() const noexcept {
    while (true) {
      const std::uint64_t before = version_.load(std::memory_order_acquire);  // M1
      const Sums sums{samples_.load(std::memory_order_relaxed), bytes_.load(std::memory_order_relaxed),
                      intervals_.load(std::memory_order_relaxed), seconds_.load(std::memory_order_relaxed),
                      squares_.load(std::memory_order_relaxed)};
      std::atomic_thread_fence(std::memory_order_acquire);  // M1
      if (before % 2 == 0 && version_.load(std::memory_order_relaxed) == before) return sums;
    }
  }
  /// The shortest and the longest time between two writes since the last call; a write meanwhile may count
  /// for either.
  std::pair<double, double> take_extremes() noexcept {
    return {least_.exchange(kNone, std::memory_order_relaxed), most_.exchange(0, std::memory_order_relaxed)};
  }

 private:
  static constexpr double kNone = std::numeric_limits<double>::infinity();

  /// One thread writes.
  template <class Number>
  static void add(std::atomic<Number>& sum, Number more) noexcept {
    sum.store(sum.load(std::memory_order_relaxed) + more, std::memory_order_relaxed);
  }
  void add_interval(double seconds) noexcept {
    add(intervals_, std::uint64_t{1});
    add(seconds_, seconds);
    add(squares_, seconds * seconds);
    if (seconds < least_.load(std::memory_order_relaxed)) least_.store(seconds, std::memory_order_relaxed);
    if (seconds > most_.load(std::memory_order_relaxed)) most_.store(seconds, std::memory_order_relaxed);
  }
  [[nodiscard]] std::size_t size_of(const task::SampleSlot& sample) const noexcept {
    if (sample.flat_size != 0) return sample.flat_size;
    if (info_ == nullptr || sample.value == nullptr) return 0;
    return info_->trivially_copyable ? info_->size : type::flat_size(*info_, sample.value);
  }

  task::OutputPortBase& port_;  ///< valid while attached
  const type::TypeInfo* const info_;
  Mutex mutex_;  ///< held while the port is detached
  bool attached_ SEGUE_GUARDED_BY(mutex_) = true;
  TimePoint last_{};  ///< the writer's
  std::atomic<std::uint64_t> version_{0};
  std::atomic<std::uint64_t> samples_{0};
  std::atomic<std::uint64_t> bytes_{0};
  std::atomic<std::uint64_t> intervals_{0};
  std::atomic<double> seconds_{0};
  std::atomic<double> squares_{0};
  std::atomic<double> least_{kNone};
  std::atomic<double> most_{0};
};

class MeterReader final : public PortReader {
 public:
  explicit MeterReader(std::shared_ptr<Meter> meter) : meter_(std::move(meter)), since_(monotonic_now()) {}
  ~MeterReader() override { meter_->disconnect(); }
  MeterReader(const MeterReader&) = delete;
  MeterReader& operator=(const MeterReader&) = delete;

  std::vector<type::Value> read(std::size_t limit) override {
    if (limit == 0) return {};
    const Lock lock(mutex_);
    const TimePoint now = monotonic_now();
    const Sums sums = meter_->sums();
    const auto [least, most] = meter_->take_extremes();
    type::ValueMap map;
    map.append("samples", sums.samples - before_.samples);
    map.append("bytes", sums.bytes - before_.bytes);
    map.append("span_s", std::chrono::duration<double>(now - since_).count());
    if (const auto count = static_cast<double>(sums.intervals - before_.intervals); count > 0) {
      const double mean = (sums.seconds - before_.seconds) / count;
      const double variance = (sums.squares - before_.squares) / count - mean * mean;
      map.append("mean_s", mean);
      map.append("least_s", std::min(least, mean));
      map.append("most_s", std::max(most, mean));
      map.append("deviation_s", variance > 0 ? std::sqrt(variance) : 0.0);
    } else {
      for (const char* none : {"mean_s", "least_s", "most_s", "deviation_s"})
        map.append(none, type::Value());
    }
    before_ = sums;
    since_ = now;
    return {type::Value(std::move(map))};
  }
  void next(std::size_t limit, const Wait& /*wait*/, SamplesAnswer answered) override {
    answered(read(limit));
  }
  [[nodiscard]] std::string type_name() const override { return ""; }

 private:
  const std::shared_ptr<Meter> meter_;
  Mutex mutex_;
  Sums before_ SEGUE_GUARDED_BY(mutex_);
  TimePoint since_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace

Result<std::unique_ptr<PortReader>> measure_writes(task::OutputPortBase& port) {
  auto meter = std::make_shared<Meter>(port);
  if (auto attached = task::OutputPortAccess::attach(port, meter, "its measurement"); !attached)
    return std::move(attached.error());
  return std::unique_ptr<PortReader>(std::make_unique<MeterReader>(std::move(meter)));
}

}  // namespace segue::task_host::detail
