// SPDX-License-Identifier: Apache-2.0
#include "hosts.hpp"

namespace demo {

using namespace segue;

Result<void> Hosts::start(std::size_t count, const std::filesystem::path& robot_file) {
  std::vector<runtime::TemporaryHost> wanted;
  for (std::size_t i = 0; i < count; ++i) {
    names_.emplace_back(1, static_cast<char>('a' + i));
    wanted.push_back({names_.back()});
  }
  if (auto started = hosts_.start(wanted); !started) return started;
  runtime::HostEntries entries;
  for (const auto& name : names_)
    entries.emplace(name, '"' + hosts_.address(name) + '"');
  auto dealt_out = runtime::deal_out(robot_file, entries, hosts_.folder() / "robot");
  if (!dealt_out) return dealt_out.error();
  robot_file_ = std::move(*dealt_out);
  return {};
}

}  // namespace demo
