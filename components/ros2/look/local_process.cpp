// SPDX-License-Identifier: Apache-2.0
#include "local_process.hpp"

#include "../participant/own_addresses.hpp"

#include <segue/base/file.hpp>
#include <segue/base/text.hpp>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <sstream>
#include <system_error>
#include <utility>

namespace ros2 {
namespace {

namespace fs = std::filesystem;

bool has_one_of(const fs::path& process, const std::vector<std::string>& sockets) {
  std::error_code problem;
  for (fs::directory_iterator file(process / "fd", problem), end; !problem && file != end;
       file.increment(problem)) {
    std::error_code unreadable;
    const fs::path target = fs::read_symlink(file->path(), unreadable);
    if (!unreadable && std::ranges::find(sockets, target.native()) != sockets.end()) return true;
  }
  return false;
}

std::string path_of(pid_t process, const char* file) {
  return "/proc/" + std::to_string(process) + "/" + file;
}

/// Its parent, and when it began (ticks since the start of the system); nothing where it has ended.
std::optional<std::pair<pid_t, std::uint64_t>> origin_of(pid_t process) {
  constexpr std::size_t kParent =
      1;  // behind the name in brackets, which may have any letters (proc_pid_stat(5))
  constexpr std::size_t kBegin = 19;
  const auto text = segue::read_file(path_of(process, "stat"));
  const std::size_t name_end = text ? text->rfind(") ") : std::string::npos;
  if (name_end == std::string::npos) return {};
  const auto words = segue::split(std::string_view(*text).substr(name_end + 2), ' ');
  if (words.size() <= kBegin) return {};
  pid_t parent = 0;
  std::uint64_t begin = 0;
  std::from_chars(words[kParent].data(), words[kParent].data() + words[kParent].size(), parent);
  std::from_chars(words[kBegin].data(), words[kBegin].data() + words[kBegin].size(), begin);
  return std::pair(parent, begin);
}

/// Of a file in which each word ends in NUL.
std::vector<std::string> words_in(pid_t process, const char* file) {
  const auto text = segue::read_file(path_of(process, file));
  std::vector<std::string> words;
  if (!text || text->empty()) return words;
  for (const std::string_view word : segue::split(std::string_view(*text).substr(0, text->size() - 1), '\0'))
    words.emplace_back(word);
  return words;
}

}  // namespace

std::vector<UdpSocket> udp_sockets() {
  constexpr std::size_t kAddress = 1;
  constexpr std::size_t kInode = 9;
  std::vector<UdpSocket> sockets;
  const auto text = segue::read_file("/proc/net/udp");
  std::istringstream lines(text ? *text : "");
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    const std::vector<std::string> cells{std::istream_iterator<std::string>(words), {}};
    if (cells.size() <= kInode) continue;
    const std::string& address = cells[kAddress];
    const std::size_t colon = address.find(':');
    if (colon == std::string::npos) continue;
    UdpSocket socket;
    const auto end = address.data() + address.size();
    if (std::from_chars(address.data() + colon + 1, end, socket.port, 16).ptr != end) continue;
    socket.file = "socket:[" + cells[kInode] + "]";
    sockets.push_back(std::move(socket));
  }
  return sockets;
}

std::optional<pid_t> first_of(const std::vector<pid_t>& processes) {
  std::optional<pid_t> first;
  std::uint64_t earliest = 0;
  for (const pid_t process : processes) {
    const auto origin = origin_of(process);
    if (!origin || std::ranges::find(processes, origin->first) != processes.end()) continue;
    if (!first || origin->second < earliest) {
      first = process;
      earliest = origin->second;
    }
  }
  return first;
}

std::optional<pid_t> process_at(const segue::ros2::UdpAddress& address) {
  if (!is_own_address(address.host)) return {};
  std::vector<std::string> sockets;
  for (UdpSocket& socket : udp_sockets()) {
    if (socket.port == address.port) sockets.push_back(std::move(socket.file));
  }
  if (sockets.empty()) return {};
  std::vector<pid_t> holders;
  std::error_code problem;
  for (fs::directory_iterator entry("/proc", problem), end; !problem && entry != end;
       entry.increment(problem)) {
    const std::string name = entry->path().filename().string();
    pid_t process = 0;
    const auto [rest, error] = std::from_chars(name.data(), name.data() + name.size(), process);
    if (error != std::errc() || rest != name.data() + name.size()) continue;
    if (has_one_of(entry->path(), sockets)) holders.push_back(process);
  }
  return first_of(holders);
}

std::vector<std::string> command_of(pid_t process) {
  return words_in(process, "cmdline");
}

std::string variable_of(pid_t process, std::string_view name) {
  const std::string start = std::string(name) + "=";
  for (const std::string& entry : words_in(process, "environ")) {
    if (entry.starts_with(start)) return entry.substr(start.size());
  }
  return {};
}

std::set<std::string> mapped_files(pid_t process) {
  std::set<std::string> files;
  const auto text = segue::read_file(path_of(process, "maps"));
  if (!text) return files;
  for (const std::string_view line : segue::split(*text, '\n')) {
    if (const auto path = line.find('/'); path != std::string_view::npos) files.emplace(line.substr(path));
  }
  return files;
}

}  // namespace ros2
