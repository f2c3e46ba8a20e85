// SPDX-License-Identifier: Apache-2.0
// The cost of a hop between two processes of one computer, compared with mechanisms of the operating system
// and with other middleware.
#include "process/hop.hpp"

#include <algorithm>
#include <cstdio>
#include <span>
#include <string>
#include <utility>

namespace {

using namespace bench;

constexpr std::pair<const char*, std::size_t> kSizes[] = {
    {"16 B", 16}, {"64 B", 64}, {"1 kB", 1000}, {"1 MB", 1'000'000}, {"100 MB", 100'000'000}};

Transports transports(bool roudi) {
  Transports all;
  all.push_back(make_futex());
  all.push_back(make_segue(SegueWay::Loaned));
  all.push_back(make_segue(SegueWay::Copied));
  all.push_back(make_segue(SegueWay::Flat));
  all.push_back(make_segue(SegueWay::Spinning));
  all.push_back(make_unix_socket());
  if (auto cyclone = make_cyclone()) all.push_back(std::move(cyclone));
  if (auto iceoryx = roudi ? make_iceoryx() : nullptr) all.push_back(std::move(iceoryx));
  return all;
}

void compare(const std::string& title, const Transports& all, Comparison::Experiment experiment,
             const HopCase& wanted) {
  Comparison comparison(title, experiment, wanted);
  for (const auto& transport : all)
    comparison.add(*transport);
  comparison.print();
}

bool is_wanted(const std::string& size, std::span<char* const> sizes) {
  return sizes.empty() || std::ranges::any_of(sizes, [&](const char* wanted) { return size == wanted; });
}

void compare_all(const Transports& all, std::span<char* const> sizes) {
  for (const auto& [name, bytes] : kSizes) {
    const std::string size = name;
    if (!is_wanted(size, sizes)) continue;
    compare("One hop between processes, " + size + ", both on one processor", all, latency, {bytes, 0});
    compare("One hop between processes, " + size + ", processors free", all, latency, {bytes, {}});
    compare("Back to back, for each sample of " + size + ", processors free", all, throughput, {bytes, {}});
  }
}

}  // namespace

/// Arguments: the sizes to measure, as in the titles ("1 MB"); default: all.
int main(int count, char** arguments) {
  const bool has_iceoryx = make_iceoryx() != nullptr;
  const auto roudi = has_iceoryx ? RouDi::start() : nullptr;
  if (make_cyclone() == nullptr) std::puts("left out: Cyclone DDS (tools/setup --bench-peers installs it)");
  if (!has_iceoryx) std::puts("left out: iceoryx (tools/setup --bench-peers installs it)");
  if (has_iceoryx && roudi == nullptr) std::puts("left out: iceoryx, whose daemon iox-roudi did not start");
  compare_all(transports(roudi != nullptr), std::span(arguments, static_cast<std::size_t>(count)).subspan(1));
}
