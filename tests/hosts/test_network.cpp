// SPDX-License-Identifier: Apache-2.0
#include "test_network.hpp"

#include <support/paths.hpp>

#include <poll.h>
#include <sched.h>
#include <spawn.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>

#include "../system/process.hpp"

extern char** environ;

namespace segue::testing {

namespace {

constexpr const char* kEnv = "/usr/bin/env";  // finds programs wherever they are

std::string make_private_mounts() {
  // Name spaces of networks have names by being mounted, which only this process and its children see.
  std::filesystem::create_directories("/run/netns");
  if (::unshare(CLONE_NEWNS) == 0 && ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
      ::mount("tmpfs", "/run/netns", "tmpfs", 0, nullptr) == 0) {
    return {};
  }
  return std::string("mounts of its own: ") + std::strerror(errno);
}

std::string find_obstacle() {
  if (::geteuid() != 0) return "only root may make name spaces";
  if (::access("/dev/net/tun", R_OK | W_OK) != 0) return "there is no /dev/net/tun";
  if (auto refused = make_private_mounts(); !refused.empty()) return refused;
  const auto tried = run({kEnv, "ip", "netns", "add", "try"});
  if (tried.status != 0) return "name spaces of networks: " + tried.errors;
  return {};
}

void ip(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {kEnv, "ip"});
  const auto done = run(arguments);
  if (done.status != 0) throw std::runtime_error("ip: " + done.errors);
}

}  // namespace

const std::string& TestNetwork::obstacle() {
  static const std::string found = find_obstacle();
  return found;
}

TestNetwork::TestNetwork(const std::vector<std::string>& stations) : stations_(stations) {
  std::vector<std::string> command = {segue::paths::kWire};
  for (const auto& station : stations_) {
    ip({"netns", "add", station});
    command.push_back(station + "=" + station);
  }
  std::array<int, 2> commands{};
  std::array<int, 2> answers{};
  if (::pipe2(commands.data(), O_CLOEXEC) != 0 || ::pipe2(answers.data(), O_CLOEXEC) != 0)
    throw std::runtime_error("pipe2");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, commands[0], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, answers[1], STDOUT_FILENO);
  std::vector<char*> words;
  for (auto& word : command)
    words.push_back(word.data());
  words.push_back(nullptr);
  const int failed = ::posix_spawn(&wire_, words[0], &actions, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(commands[0]);
  ::close(answers[1]);
  commands_ = commands[1];
  answers_ = answers[0];
  if (failed != 0 || answer() != "ready") throw std::runtime_error("the network cannot be started");
  for (const auto& station : stations_) {
    ip({"-n", station, "link", "set", "lo", "up"});
    ip({"-n", station, "addr", "add", address(station) + "/24", "dev", "eth"});
    ip({"-n", station, "link", "set", "eth", "up"});
  }
}

TestNetwork::~TestNetwork() {
  ::close(commands_);
  ::waitpid(wire_, nullptr, 0);
  ::close(answers_);
  for (const auto& station : stations_)
    (void)run({kEnv, "ip", "netns", "del", station});
}

std::vector<std::string> TestNetwork::launcher(const std::string& station) {
  return {kEnv, "ip", "netns", "exec", station};
}

std::string TestNetwork::address(const std::string& station) const {
  std::size_t number = 1;
  while (stations_.at(number - 1) != station)
    ++number;
  return "10.213.79." + std::to_string(number);
}

std::string TestNetwork::say(const std::string& line) {
  const std::string text = line + "\n";
  if (::write(commands_, text.data(), text.size()) != static_cast<ssize_t>(text.size()))
    throw std::runtime_error("the network has ended");
  std::string before;
  for (;;) {
    const std::string next = answer();
    if (next == "ok") return before;
    if (next.starts_with("error:")) throw std::runtime_error(line + ": " + next);
    before += next + "\n";
  }
}

std::string TestNetwork::answer() {
  for (;;) {
    if (const auto end = read_.find('\n'); end != std::string::npos) {
      const std::string line = read_.substr(0, end);
      read_.erase(0, end + 1);
      return line;
    }
    pollfd ready{answers_, POLLIN, 0};
    std::array<char, 4096> buffer{};
    ssize_t size = 0;
    if (::poll(&ready, 1, static_cast<int>(std::chrono::milliseconds(kPatience).count())) == 1)
      size = ::read(answers_, buffer.data(), buffer.size());
    if (size <= 0) throw std::runtime_error("the network does not answer");
    read_.append(buffer.data(), static_cast<std::size_t>(size));
  }
}

}  // namespace segue::testing
