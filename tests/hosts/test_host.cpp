// SPDX-License-Identifier: Apache-2.0
#include "test_host.hpp"

#include <support/eventually.hpp>
#include <support/paths.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <set>
#include <utility>

#include "../fault/processes.hpp"

namespace segue::testing {

TestHost::TestHost(std::string name, const std::filesystem::path& folder, Surroundings surroundings)
    : name_(std::move(name)), folder_(folder / name_), surroundings_(std::move(surroundings)) {
  std::filesystem::create_directories(runtime_folder());
}

TestHost::~TestHost() {
  kill();
}

std::string TestHost::address() const {
  if (!surroundings_.address.empty()) return surroundings_.address;
  return "unix:" + (runtime_folder() / "segue" / "@host.sock").string();
}

void TestHost::start() {
  std::vector<std::string> command = surroundings_.launcher;
  command.insert(command.end(),
                 {segue::paths::kProgram, "host", "--name", name_, "--state", state_folder().string()});
  command.insert(command.end(), surroundings_.options.begin(), surroundings_.options.end());
  auto environment = surroundings_.environment;
  environment["XDG_RUNTIME_DIR"] = runtime_folder().string();
  daemon_ = std::make_unique<LoggedProcess>(command, folder_, folder_ / "daemon.log", environment);
  EXPECT_TRUE(daemon_->wait_for("host " + name_ + " is running")) << daemon_->output();
}

void TestHost::stop() {
  daemon_->signal(SIGTERM);
  EXPECT_EQ(daemon_->wait(), 0) << daemon_->output();
}

void TestHost::signal_all(int number) const {
  for (const auto& [pid, program] : processes_of(runtime_folder()))
    ::kill(pid, number);
}

void TestHost::kill() {
  // What starts a process may have done so since its processes were listed.
  const bool gone = eventually([this] {
    signal_all(SIGKILL);
    return processes_of(runtime_folder()).empty();
  });
  EXPECT_TRUE(gone) << "host " << name_ << " cannot be killed";
  if (daemon_) (void)daemon_->wait();
}

void TestHost::reboot() {
  kill();
  for (const auto& entry : std::filesystem::directory_iterator(runtime_folder()))
    std::filesystem::remove_all(entry.path());
  start();
}

void TestHost::kill_daemon() {
  std::set<pid_t> kept;
  for (const auto& [name, pid] : deployments())
    kept.insert(pid);
  for (const auto& [pid, program] : processes_of(runtime_folder())) {
    if (!kept.contains(pid)) ::kill(pid, SIGKILL);
  }
  EXPECT_EQ(daemon_->wait(), 128 + SIGKILL);
}

void TestHost::freeze() {
  signal_all(SIGSTOP);
  const bool still = eventually([this] {
    signal_all(SIGSTOP);
    const auto all = processes_of(runtime_folder());
    return std::all_of(all.begin(), all.end(), [](const auto& one) { return state_of(one.first) == 'T'; });
  });
  EXPECT_TRUE(still);
}

void TestHost::thaw() {
  signal_all(SIGCONT);
}

std::map<std::string, pid_t> TestHost::deployments() const {
  std::map<std::string, pid_t> found;
  for (const auto& [title, pid] : deployments_of(runtime_folder()))
    found.emplace(title.substr(0, title.find('@')), pid);  // "work@a"
  return found;
}

}  // namespace segue::testing
