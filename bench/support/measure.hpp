// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

/// Common parts of the benchmarks: repeated measurements, and tables that compare each value with the
/// baseline of the same run.
namespace bench {

using segue::Duration;

struct Summary {
  Duration min{0};
  Duration median{0};
  Duration p99{0};
  std::size_t count = 0;
};

/// Statistics of durations in any order; all zero if there are none.
Summary summarise(std::vector<Duration> durations);

/// Durations of `work`, repeated `repeats` times after a few runs that are not counted.
Summary measure(std::size_t repeats, const std::function<void()>& work);
/// Durations of `work`, with a preparation before each repetition that is not timed.
Summary measure(std::size_t repeats, const std::function<void()>& prepare, const std::function<void()>& work);

/// Waits without occupying a processor: looks every 50 us.
void wait_for(const std::function<bool()>& done);

/// Rows of one experiment. Printed as a table, or as CSV if `SEGUE_BENCH_CSV` is set.
class Table {
 public:
  explicit Table(std::string title);
  /// Durations are divided by `per` (a number of hops or tasks). The median is compared with `floor`.
  void add(const std::string& name, const Summary& summary, std::size_t per = 1,
           Duration floor = Duration{0});
  /// A row without durations.
  void note(const std::string& name, const std::string& text);
  void print() const;

 private:
  struct Row {
    std::string name;
    std::string text;  ///< of a note
    double median_us = 0;
    double min_us = 0;
    double p99_us = 0;
    double ratio = 0;  ///< 0: no baseline
    std::size_t count = 0;
  };
  std::string title_;
  std::vector<Row> rows_;
};

/// Keeps the optimiser from dropping a value.
template <class T>
void keep(const T& value) {
  asm volatile("" : : "g"(&value) : "memory");
}

}  // namespace bench
