// SPDX-License-Identifier: Apache-2.0
#include "processes.hpp"

#include <segue/base/file.hpp>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <system_error>
#include <vector>

namespace segue::testing {

namespace {

namespace fs = std::filesystem;

/// Empty if the process ends meanwhile.
std::string text_of(const fs::path& file) {
  return read_file(file).value_or("");
}

fs::path folder_of(pid_t pid) {
  return fs::path("/proc") / std::to_string(pid);
}

/// Those that are found until the process ends.
std::vector<fs::path> entries(const fs::path& folder) {
  std::error_code gone;
  std::vector<fs::path> found;
  for (fs::directory_iterator at(folder, gone); !gone && at != fs::directory_iterator(); at.increment(gone))
    found.push_back(at->path());
  return found;
}

/// The names of the pools in segue/ whose threads serve calls, actions and hosts.
constexpr std::array kPools{"segue-actions", "segue-calls",   "segue-fleet",
                            "segue-hosts",   "segue-ordered", "segue-urgent"};

std::map<std::string, std::size_t> threads_of(pid_t pid) {
  std::map<std::string, std::size_t> threads;
  for (const fs::path& thread : entries(folder_of(pid) / "task")) {
    std::string name = text_of(thread / "comm");
    if (name.empty()) continue;  // it has ended meanwhile
    name.pop_back();             // the end of the line
    if (std::find(kPools.begin(), kPools.end(), name) == kPools.end()) ++threads[name];
  }
  return threads;
}

}  // namespace

std::map<pid_t, std::string> processes_of(const fs::path& runtime_folder) {
  const std::string wanted = "XDG_RUNTIME_DIR=" + runtime_folder.string();
  std::map<pid_t, std::string> found;
  for (const fs::path& entry : entries("/proc")) {
    const std::string name = entry.filename();
    if (!std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isdigit(c) != 0; })) {
      continue;
    }
    const pid_t pid = std::stoi(name);
    const std::string environment = '\0' + text_of(entry / "environ");
    const bool is_ours = environment.find('\0' + wanted + '\0') != std::string::npos;
    if (!is_ours || pid == ::getpid() || state_of(pid) == 'Z') {
      continue;
    }
    std::error_code gone;
    const fs::path program = fs::read_symlink(entry / "exe", gone);
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
    // "segue-deployment\0robot/process\0"; a zygote and its spare child have no robot
    std::istringstream words(text_of(folder_of(pid) / "cmdline"));
    std::string title;
    std::getline(words, title, '\0');
    std::getline(words, title, '\0');
    if (const auto slash = title.find('/'); slash != std::string::npos) {
      found.emplace(title.substr(slash + 1), pid);
    }
  }
  return found;
}

Holdings holdings_of(pid_t pid) {
  Holdings holdings;
  holdings.threads = threads_of(pid);
  holdings.descriptors = entries(folder_of(pid) / "fd").size();
  std::istringstream maps(text_of(folder_of(pid) / "maps"));
  for (std::string line; std::getline(maps, line);) {
    holdings.memory_maps += line.find("/memfd:") == std::string::npos ? 0 : 1;
  }
  return holdings;
}

bool has_grown(const Holdings& before, const Holdings& now) {
  const bool has_more_threads = std::any_of(now.threads.begin(), now.threads.end(), [&](const auto& thread) {
    const auto found = before.threads.find(thread.first);
    return thread.second > (found == before.threads.end() ? 1 : found->second);
  });
  return has_more_threads || now.descriptors > before.descriptors || now.memory_maps > before.memory_maps;
}

std::string to_string(const Holdings& holdings) {
  std::string threads;
  for (const auto& [name, count] : holdings.threads)
    threads += (threads.empty() ? "" : ", ") + name + ": " + std::to_string(count);
  return "threads (" + threads + "), " + std::to_string(holdings.descriptors) + " descriptors, " +
         std::to_string(holdings.memory_maps) + " maps of shared memory";
}

char state_of(pid_t pid) {
  const std::string stat = text_of(folder_of(pid) / "stat");
  const std::size_t name_end = stat.rfind(')');  // the name may have anything in it
  return name_end == std::string::npos || name_end + 2 >= stat.size() ? '\0' : stat[name_end + 2];
}

}  // namespace segue::testing
