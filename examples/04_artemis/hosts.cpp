// SPDX-License-Identifier: Apache-2.0
#include "hosts.hpp"

#include <segue/base/file.hpp>
#include <segue/model/files.hpp>

namespace demo {

namespace fs = std::filesystem;
using namespace segue;

Result<void> Hosts::start(std::size_t count, const fs::path& robot_file) {
  std::vector<runtime::TemporaryHost> wanted;
  for (std::size_t i = 0; i < count; ++i) {
    names_.emplace_back(1, static_cast<char>('a' + i));
    wanted.push_back({names_.back()});
  }
  if (auto started = hosts_.start(wanted); !started) return started;
  return deal_out(robot_file);
}

Result<void> Hosts::deal_out(const fs::path& robot_file) const {
  Diagnostics diagnostics;
  const auto robot = model::load_robot(robot_file, diagnostics);
  if (!robot) return diagnostics.to_error();
  fs::create_directories(this->robot_file().parent_path());
  std::string text = "robot: " + robot->name + "\ncontrollers: [\"*.net\"]\nhosts:\n";
  for (const auto& name : names_)
    text += "  " + name + ": \"" + hosts_.address(name) + "\"\n";
  if (auto written = write_file(this->robot_file(), text); !written) return written;
  for (const auto& controllers : robot->controllers) {
    for (const auto& file : glob_files(robot->folder / controllers)) {
      auto network = model::load_network(file, diagnostics);
      if (!network) return diagnostics.to_error();
      runtime::deal_out(*network, names_);
      const auto here = this->robot_file().parent_path() / (network->name.str() + ".net");
      if (auto written = write_file(here, model::write_network(*network)); !written) return written;
    }
  }
  return {};
}

}  // namespace demo
