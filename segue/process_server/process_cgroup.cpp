// SPDX-License-Identifier: Apache-2.0
#include <segue/base/descriptor.hpp>
#include <segue/process_server/process_cgroup.hpp>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace segue::process_server::detail {

namespace {

bool put(const std::filesystem::path& file, const std::string& text) {
  const Descriptor opened(::open(file.c_str(), O_WRONLY | O_CLOEXEC));
  return opened.valid() &&
         ::write(opened.get(), text.data(), text.size()) == static_cast<ssize_t>(text.size());
}

}  // namespace

std::filesystem::path enter_cgroup(const std::filesystem::path& parent, const std::string& title, int pid,
                                   std::optional<std::uint64_t> memory) {
  std::string name = "segue." + title;
  std::replace(name.begin(), name.end(), '/', '.');
  std::filesystem::path group = parent / name;
  if (::mkdir(group.c_str(), 0755) != 0 && errno != EEXIST) return {};
  if (!put(group / "cgroup.procs", std::to_string(pid))) {
    ::rmdir(group.c_str());
    return {};
  }
  // Fails where the parent does not delegate the memory controller; then only the rlimit of the process
  // holds.
  if (memory) put(group / "memory.max", std::to_string(*memory));
  return group;
}

void kill_cgroup(const std::filesystem::path& group) {
  if (!group.empty()) put(group / "cgroup.kill", "1");
}

void remove_cgroup(const std::filesystem::path& group) {
  if (!group.empty()) ::rmdir(group.c_str());
}

}  // namespace segue::process_server::detail
