// SPDX-License-Identifier: Apache-2.0
#include "transport.hpp"

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace bench {
namespace {

void write_config(const std::string& path) {
  std::ofstream file(path);
  file << "[general]\nversion = 1\n\n[[segment]]\n";
  for (const auto& [size, count] : {std::pair{256, 512}, {4096, 128}, {1'048'576, 32}, {100'000'256, 4}})
    file << "\n[[segment.mempool]]\nsize = " << (size + 31) / 32 * 32 << "\ncount = " << count << "\n";
}

/// RouDi says so on its output.
bool wait_until_ready(pid_t pid, const std::string& output) {
  for (int i = 0; i < 1000; ++i) {
    std::ifstream file(output);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    if (text.find("ready for clients") != std::string::npos) return true;
    if (::waitpid(pid, nullptr, WNOHANG) != 0) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

pid_t spawn_roudi(const std::string& config, const std::string& output) {
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output.c_str(), O_WRONLY | O_CREAT, 0600);
  ::posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  std::string program = "iox-roudi";
  std::string option = "-c";
  std::string path = config;
  std::string level_option = "-l";
  std::string level = "warning";
  char* arguments[] = {program.data(),      option.data(), path.data(),
                       level_option.data(), level.data(),  nullptr};
  pid_t pid = -1;
  const int failed = ::posix_spawnp(&pid, "iox-roudi", &actions, nullptr, arguments, environ);
  ::posix_spawn_file_actions_destroy(&actions);
  return failed == 0 ? pid : -1;
}

}  // namespace

std::unique_ptr<RouDi> RouDi::start() {
  std::string folder = std::filesystem::temp_directory_path() / "segue-bench-XXXXXX";
  if (::mkdtemp(folder.data()) == nullptr) return nullptr;
  write_config(folder + "/roudi.toml");
  const std::string output = folder + "/roudi.log";
  const pid_t pid = spawn_roudi(folder + "/roudi.toml", output);
  auto daemon = std::unique_ptr<RouDi>(new RouDi(pid, folder));
  if (pid <= 0 || !wait_until_ready(pid, output)) daemon.reset();
  return daemon;
}

RouDi::~RouDi() {
  if (pid_ > 0) ::kill(pid_, SIGTERM);
  for (int i = 0; pid_ > 0 && i < 500 && ::waitpid(pid_, nullptr, WNOHANG) == 0; ++i) {
    if (i == 400) ::kill(pid_, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

}  // namespace bench
