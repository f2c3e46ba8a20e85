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
#include <sys/prctl.h>
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

/// RouDi reports on its output that it is ready.
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

/// Ends with this process, even if that is killed.
pid_t start_roudi(const std::string& config, const std::string& output) {
  const pid_t pid = ::fork();
  if (pid != 0) return pid;
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  const int file = ::open(output.c_str(), O_WRONLY | O_CREAT, 0600);
  ::dup2(file, STDOUT_FILENO);
  ::dup2(file, STDERR_FILENO);
  ::execlp("iox-roudi", "iox-roudi", "-c", config.c_str(), "-l", "warning", nullptr);
  std::_Exit(127);
}

}  // namespace

std::unique_ptr<RouDi> RouDi::start() {
  std::string folder = std::filesystem::temp_directory_path() / "segue-bench-XXXXXX";
  if (::mkdtemp(folder.data()) == nullptr) return nullptr;
  write_config(folder + "/roudi.toml");
  const std::string output = folder + "/roudi.log";
  const pid_t pid = start_roudi(folder + "/roudi.toml", output);
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
