// SPDX-License-Identifier: Apache-2.0
#include "measure.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <utility>

namespace bench {
namespace {

double microseconds(Duration duration, std::size_t per) {
  return static_cast<double>(duration.count()) / 1e3 / static_cast<double>(per);
}

}  // namespace

Summary summarise(std::vector<Duration> durations) {
  if (durations.empty()) return {};
  std::ranges::sort(durations);
  const std::size_t last = durations.size() - 1;
  return {durations.front(), durations[last / 2], durations[last * 99 / 100], durations.size()};
}

void wait_for(const std::function<bool()>& done) {
  while (!done())
    std::this_thread::sleep_for(std::chrono::microseconds(50));
}

Summary measure(std::size_t repeats, const std::function<void()>& prepare,
                const std::function<void()>& work) {
  constexpr std::size_t kWarmUp = 3;
  std::vector<Duration> durations;
  durations.reserve(repeats);
  for (std::size_t i = 0; i < repeats + kWarmUp; ++i) {
    if (prepare) prepare();
    const auto begin = segue::RealClock::instance().now();
    work();
    const auto end = segue::RealClock::instance().now();
    if (i >= kWarmUp) durations.push_back(end - begin);
  }
  return summarise(std::move(durations));
}

Summary measure(std::size_t repeats, const std::function<void()>& work) {
  return measure(repeats, {}, work);
}

Table::Table(std::string title) : title_(std::move(title)) {}

void Table::add(const std::string& name, const Summary& summary, std::size_t per, Duration floor) {
  Row row;
  row.name = name;
  row.median_us = microseconds(summary.median, per);
  row.min_us = microseconds(summary.min, per);
  row.p99_us = microseconds(summary.p99, per);
  row.count = summary.count;
  if (floor.count() > 0) row.ratio = row.median_us / microseconds(floor, 1);
  rows_.push_back(std::move(row));
}

void Table::note(const std::string& name, const std::string& text) {
  Row row;
  row.name = name;
  row.text = text;
  rows_.push_back(std::move(row));
}

void Table::print() const {
  if (std::getenv("SEGUE_BENCH_CSV") != nullptr) {
    for (const Row& row : rows_) {
      if (!row.text.empty()) continue;
      std::printf("%s,%s,%.3f,%.3f,%.3f,%.3f,%zu\n", title_.c_str(), row.name.c_str(), row.median_us,
                  row.min_us, row.p99_us, row.ratio, row.count);
    }
    return;
  }
  std::printf("\n%s\n  %-54s %12s %12s %12s %9s\n", title_.c_str(), "", "median us", "min us", "99 % us",
              "x floor");
  for (const Row& row : rows_) {
    if (!row.text.empty()) {
      std::printf("  %-54s %s\n", row.name.c_str(), row.text.c_str());
      continue;
    }
    std::printf("  %-54s %12.3f %12.3f %12.3f", row.name.c_str(), row.median_us, row.min_us, row.p99_us);
    if (row.ratio > 0) std::printf(" %9.2f", row.ratio);
    std::putchar('\n');
  }
}

}  // namespace bench
