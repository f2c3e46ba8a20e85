// SPDX-License-Identifier: Apache-2.0
#include "processes.hpp"

#include <segue/base/file.hpp>

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace demo {
namespace {

namespace fs = std::filesystem;

/// Empty where the process has ended.
std::string content(const fs::path& file) {
  return segue::read_file(file).value_or("");
}

/// The parent's pid is the second field after the command, which is in parentheses.
int parent_of(const fs::path& process) {
  const std::string stat = content(process / "stat");
  const auto end = stat.rfind(')');
  if (end == std::string::npos) return 0;
  std::istringstream fields(stat.substr(end + 1));
  char state = 0;
  int parent = 0;
  fields >> state >> parent;
  return parent;
}

/// A child of this process, or of a zygote, which is a child of this process or of a daemon.
bool is_ours(fs::path process) {
  constexpr int kGenerations = 3;
  for (int i = 0; i < kGenerations; ++i) {
    const int parent = parent_of(process);
    if (parent == ::getpid()) return true;
    process = fs::path("/proc") / std::to_string(parent);
  }
  return false;
}

/// "rover_io", from its arguments "segue-deployment", "artemis/rover_io"; on other hosts "rover_io@a"; "" for
/// any other program, and for the zygote and its spare child.
std::string deployment_name(const fs::path& process) {
  const std::string command = content(process / "cmdline");
  const auto program = command.find('\0');
  if (program == std::string::npos || command.find("segue-deployment") > program) return {};
  const std::string name = command.substr(program + 1, command.find('\0', program + 1) - program - 1);
  const auto slash = name.find('/');
  return slash == std::string::npos ? std::string() : name.substr(slash + 1);
}

void add_pools(const fs::path& process, std::set<std::string>& inodes) {
  std::ifstream maps(process / "maps");
  for (std::string line; std::getline(maps, line);) {
    const bool is_pool = line.find("/memfd:segue-") != std::string::npos &&
                         line.find("/memfd:segue-commits") == std::string::npos;
    if (!is_pool) continue;
    std::istringstream fields(line);
    std::string range, rights, offset, device, inode;
    fields >> range >> rights >> offset >> device >> inode;
    inodes.insert(inode);
  }
}

}  // namespace

Processes look_at_processes() {
  Processes found;
  std::set<std::string> inodes;
  add_pools("/proc/self", inodes);
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string number = entry.path().filename();
    const bool is_process =
        std::all_of(number.begin(), number.end(), [](unsigned char c) { return std::isdigit(c); });
    if (!is_process || !is_ours(entry.path())) continue;
    const std::string name = deployment_name(entry.path());
    if (name.empty()) continue;
    found.names.insert(name);
    add_pools(entry.path(), inodes);
  }
  found.pools = inodes.size();
  return found;
}

}  // namespace demo
