// SPDX-License-Identifier: Apache-2.0
#include <segue/base/process_state.hpp>

#include <csignal>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>

namespace segue {

namespace {

/// PF_EXITING of the kernel's sched.h, shown by proc(5): set as soon as a process begins to exit.
constexpr std::uint64_t kExiting = 0x4;
constexpr std::uint64_t kKillSignal = std::uint64_t{1} << (SIGKILL - 1);

/// By proc(5): "PID (NAME) STATE parent group session terminal foreground FLAGS ...".
bool is_exiting(const std::string& folder) {
  std::ifstream file(folder + "/stat");
  std::string text;
  std::getline(file, text, '\0');
  const auto name_end = text.rfind(')');  // the name may contain anything
  if (name_end == std::string::npos) return false;
  std::istringstream words(text.substr(name_end + 1));
  char state = 0;
  std::int64_t skipped = 0;
  std::uint64_t flags = 0;
  words >> state;
  for (int i = 0; i < 5; ++i)
    words >> skipped;
  words >> flags;
  return state == 'Z' || state == 'X' || (flags & kExiting) != 0;
}

/// Whether SIGKILL is pending: the process has not run since it was killed.
bool is_killed(const std::string& folder) {
  std::ifstream file(folder + "/status");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("SigPnd:") && !line.starts_with("ShdPnd:")) continue;
    std::istringstream words(line.substr(line.find(':') + 1));
    std::uint64_t pending = 0;
    words >> std::hex >> pending;
    if ((pending & kKillSignal) != 0) return true;
  }
  return false;
}

}  // namespace

bool is_ending(int pid) {
  const std::string folder = "/proc/" + std::to_string(pid);
  return is_exiting(folder) || is_killed(folder);
}

}  // namespace segue
