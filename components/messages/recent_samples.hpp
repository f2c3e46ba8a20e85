// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace messages {

/// The last samples of something, each with the time at which it was so (its member `time`, s), to be looked
/// up by time. Never allocates. One thread at a time.
template <class Sample, std::size_t Capacity = 128>
class RecentSamples {
 public:
  /// Must come in the order of their times; one that is older than the newest, as after a restart of a
  /// simulation, begins anew. Ignored if its time is not finite.
  void add(const Sample& sample) {
    if (!std::isfinite(sample.time)) return;
    if (!empty() && sample.time < newest().time) clear();
    if (count_ == Capacity) {
      first_ = (first_ + 1) % Capacity;
      --count_;
    }
    samples_[(first_ + count_) % Capacity] = sample;
    ++count_;
  }
  void clear() { count_ = 0; }
  [[nodiscard]] bool empty() const { return count_ == 0; }
  /// These functions require that it is not empty.
  [[nodiscard]] const Sample& oldest() const { return sample(0); }
  [[nodiscard]] const Sample& newest() const { return sample(count_ - 1); }

  /// Two samples in a row, and where a time lies between them: 0 at the first, below 1.
  struct Between {
    const Sample& before;
    const Sample& after;
    double share;
  };
  /// Requires a time from oldest().time to less than newest().time.
  [[nodiscard]] Between around(double time) const {
    std::size_t after = count_ - 1;
    while (sample(after - 1).time > time)
      --after;
    const Sample& a = sample(after - 1);
    const Sample& b = sample(after);
    return {a, b, (time - a.time) / (b.time - a.time)};
  }

 private:
  [[nodiscard]] const Sample& sample(std::size_t age) const { return samples_[(first_ + age) % Capacity]; }

  std::array<Sample, Capacity> samples_{};
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

}  // namespace messages
