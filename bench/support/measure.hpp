// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

/// What the hand-made benchmarks share: repeated measurement, a table with the floor of the same run beside
/// each figure.
namespace bench {

using segue::Duration;

struct Summary {
  Duration min{0};
  Duration median{0};
  Duration p99{0};
  std::size_t count = 0;
};

/// Of durations in any order; all zero if there are none.
Summary summarise(std::vector<Duration> durations);

/// How long `work` takes, `repeats` times, the first few not counted.
Summary measure(std::size_t repeats, const std::function<void()>& work);
/// The same with something before each repetition that is not timed.
Summary measure(std::size_t repeats, const std::function<void()>& prepare, const std::function<void()>& work);

/// Rows of one experiment. Printed as a table for people, or as CSV where `SEGUE_BENCH_CSV` is set.
class Table {
 public:
  explicit Table(std::string title);
  /// `per`: by how many the durations are divided (hops, tasks). `floor`: what the median is compared with,
  /// as it is.
  void add(const std::string& name, const Summary& summary, std::size_t per = 1,
           Duration floor = Duration{0});
  /// A row that is no duration.
  void note(const std::string& name, const std::string& text);
  void print() const;

 private:
  struct Row {
    std::string name;
    std::string text;  ///< of a note
    double median_us = 0;
    double min_us = 0;
    double p99_us = 0;
    double ratio = 0;  ///< 0: no floor
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
