// SPDX-License-Identifier: Apache-2.0
// The cost of a hop between two hosts, by way of both gateways, compared with Cyclone DDS alone and with TCP.
#include "process/hop.hpp"
#include "remote/remote.hpp"

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>

namespace {

using namespace bench;

constexpr std::pair<const char*, std::size_t> kSizes[] = {{"16 B", 16},          {"1 kB", 1000},
                                                          {"64 kB", 64'000},     {"1 MB", 1'000'000},
                                                          {"10 MB", 10'000'000}, {"100 MB", 100'000'000}};

struct Wanted {
  Route route;
  std::vector<std::string> sizes;
};

void compare(const std::string& title, Wanted& wanted, Comparison::Experiment experiment, std::size_t bytes) {
  Comparison comparison(title, experiment, {bytes, {}});
  const auto add = [&](const std::unique_ptr<Transport>& transport) {
    comparison.add(*transport);
    ++wanted.route.run;
  };
  add(make_remote_cyclone(wanted.route, CycloneReader::WaitSet));
  add(make_remote_cyclone(wanted.route, CycloneReader::Listener));
  add(make_remote_segue(wanted.route, Layout::Fixed));
  add(make_remote_segue(wanted.route, Layout::Vector));
  add(make_tcp(wanted.route));
  comparison.print();
}

Wanted read_arguments(int count, char** arguments) {
  Wanted wanted;
  for (int i = 1; i < count; ++i) {
    const std::string word = arguments[i];
    if (word == "--writer" && i + 2 < count) {
      wanted.route.writer = {arguments[i + 2], arguments[i + 1]};
      i += 2;
    } else if (word == "--reader" && i + 2 < count) {
      wanted.route.reader = {arguments[i + 2], arguments[i + 1]};
      i += 2;
    } else {
      wanted.sizes.push_back(word);
    }
  }
  return wanted;
}

}  // namespace

/// Arguments: the sizes to measure, as in the titles ("1 MB"), default all; and, to measure between network
/// name spaces, `--writer NAME ADDRESS --reader NAME ADDRESS`.
int main(int count, char** arguments) {
  Wanted wanted = read_arguments(count, arguments);
  for (const auto& [name, bytes] : kSizes) {
    const std::string size = name;
    if (!wanted.sizes.empty() && std::ranges::find(wanted.sizes, size) == wanted.sizes.end()) continue;
    compare("One hop between hosts, " + size, wanted, latency, bytes);
    compare("Back to back between hosts, for each sample of " + size, wanted, throughput, bytes);
  }
}
