// SPDX-License-Identifier: Apache-2.0
#include "processes.hpp"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>

namespace segue::testing {

namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

fs::path folder_of(pid_t pid) {
  return fs::path("/proc") / std::to_string(pid);
}

std::size_t entries(const fs::path& folder) {
  std::error_code error;
  const fs::directory_iterator begin(folder, error);
  return error ? 0 : static_cast<std::size_t>(std::distance(begin, fs::directory_iterator()));
}

std::size_t threads_of(pid_t pid) {
  std::error_code gone;
  std::size_t threads = 0;
  for (const auto& thread : fs::directory_iterator(folder_of(pid) / "task", gone)) {
    const std::string name = text_of(thread.path() / "comm");
    threads += name == "segue-fleet\n" || name == "segue-calls\n" ? 0 : 1;
  }
  return threads;
}

}  // namespace

std::map<pid_t, std::string> processes_of(const fs::path& runtime_folder) {
  const std::string wanted = "XDG_RUNTIME_DIR=" + runtime_folder.string();
  std::map<pid_t, std::string> found;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string name = entry.path().filename();
    if (!std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isdigit(c) != 0; })) {
      continue;
    }
    const pid_t pid = std::stoi(name);
    const std::string environment = '\0' + text_of(entry.path() / "environ");
    const bool is_ours = environment.find('\0' + wanted + '\0') != std::string::npos;
    if (!is_ours || pid == ::getpid() || state_of(pid) == 'Z') {
      continue;
    }
    std::error_code gone;
    const fs::path program = fs::read_symlink(entry.path() / "exe", gone);
    if (!gone) {
      found.emplace(pid, program.filename());
    }
  }
  return found;
}

std::map<std::string, pid_t> deployments_of(const fs::path& runtime_folder) {
  std::map<std::string, pid_t> found;
  for (const auto& [pid, program] : processes_of(runtime_folder)) {
    if (program != "segue-deployment") {
      continue;
    }
    // "segue-deployment\0robot/process\0"
    std::istringstream words(text_of(folder_of(pid) / "cmdline"));
    std::string title;
    std::getline(words, title, '\0');
    std::getline(words, title, '\0');
    found.emplace(title.substr(title.find('/') + 1), pid);
  }
  return found;
}

Holdings holdings_of(pid_t pid) {
  Holdings holdings;
  holdings.threads = threads_of(pid);
  holdings.descriptors = entries(folder_of(pid) / "fd");
  std::istringstream maps(text_of(folder_of(pid) / "maps"));
  for (std::string line; std::getline(maps, line);) {
    holdings.memory_maps += line.find("/memfd:") == std::string::npos ? 0 : 1;
  }
  return holdings;
}

std::string to_string(const Holdings& holdings) {
  return std::to_string(holdings.threads) + " threads, " + std::to_string(holdings.descriptors) +
         " descriptors, " + std::to_string(holdings.memory_maps) + " maps of shared memory";
}

char state_of(pid_t pid) {
  const std::string stat = text_of(folder_of(pid) / "stat");
  const std::size_t name_end = stat.rfind(')');  // the name may have anything in it
  return name_end == std::string::npos || name_end + 2 >= stat.size() ? '\0' : stat[name_end + 2];
}

}  // namespace segue::testing
