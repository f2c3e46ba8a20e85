// SPDX-License-Identifier: Apache-2.0
#include "hosts.hpp"

#include <segue/base/child_process.hpp>
#include <segue/base/file.hpp>
#include <segue/base/text.hpp>
#include <segue/model/files.hpp>

#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <thread>

namespace demo {
namespace {

namespace fs = std::filesystem;
using namespace segue;

constexpr int kDomains = 230;  // of DDS
constexpr auto kPatience = std::chrono::seconds(30);

/// The same for a process in all controllers (FNV-1a).
std::uint32_t hash(const std::string& name) {
  std::uint32_t value = 2166136261U;
  for (const char c : name)
    value = (value ^ static_cast<unsigned char>(c)) * 16777619U;
  return value;
}

fs::path runtime_folder_of(const fs::path& folder, const std::string& host) {
  return folder / host / "run";
}

fs::path socket_of(const fs::path& folder, const std::string& host) {
  return runtime_folder_of(folder, host) / "segue" / "@host.sock";
}

}  // namespace

Result<void> Hosts::start(std::size_t count, const fs::path& robot_file) {
  std::string pattern = (fs::temp_directory_path() / "artemis-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) return fail(ErrorCode::IoError, "cannot create " + pattern);
  folder_ = pattern;
  for (std::size_t i = 0; i < count; ++i)
    names_.emplace_back(1, static_cast<char>('a' + i));
  // Demos that run at the same time do not look for each other's hosts.
  ::setenv("ROS_DOMAIN_ID", std::to_string(1 + ::getpid() % kDomains).c_str(), 0);
  for (const auto& name : names_) {
    if (auto started = start_daemon(name); !started) return started;
  }
  return deal_out(robot_file);
}

Result<void> Hosts::start_daemon(const std::string& name) {
  fs::create_directories(runtime_folder_of(folder_, name));
  ChildProcess child(3);
  for (int number = 0; number < 2; ++number) {
    if (auto opened = child.open_null(number); !opened) return opened;
  }
  if (auto given = child.hand_over(STDERR_FILENO, STDERR_FILENO); !given) return given;
  child.set_environment({{"XDG_RUNTIME_DIR", runtime_folder_of(folder_, name).string()}});
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "segue";
  const auto state = (folder_ / name / "state").string();
  auto pid = child.start(program.string(), {"segue", "host", "--name", name, "--state", state});
  if (!pid) return pid.error();
  daemons_.push_back(*pid);
  const auto give_up = std::chrono::steady_clock::now() + kPatience;
  while (!fs::exists(socket_of(folder_, name))) {
    if (std::chrono::steady_clock::now() > give_up)
      return fail(ErrorCode::DeadlineExceeded, "host " + quote(name) + " does not start");
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return {};
}

Result<void> Hosts::deal_out(const fs::path& robot_file) const {
  Diagnostics diagnostics;
  const auto robot = model::load_robot(robot_file, diagnostics);
  if (!robot) return diagnostics.to_error();
  fs::create_directories(this->robot_file().parent_path());
  std::string text = "robot: " + robot->name + "\ncontrollers: [\"*.net\"]\nhosts:\n";
  for (const auto& name : names_)
    text += "  " + name + ": \"unix:" + socket_of(folder_, name).string() + "\"\n";
  if (auto written = write_file(this->robot_file(), text); !written) return written;
  for (const auto& controllers : robot->controllers) {
    for (const auto& file : glob_files(robot->folder / controllers)) {
      auto network = model::load_network(file, diagnostics);
      if (!network) return diagnostics.to_error();
      for (auto& deployment : network->deployments)
        deployment.host = model::HostName(names_[hash(deployment.process.str()) % names_.size()]);
      const auto here = this->robot_file().parent_path() / (network->name.str() + ".net");
      if (auto written = write_file(here, model::write_network(*network)); !written) return written;
    }
  }
  return {};
}

Hosts::~Hosts() {
  for (const pid_t daemon : daemons_)
    ::kill(daemon, SIGTERM);
  for (const pid_t daemon : daemons_)
    ::waitpid(daemon, nullptr, 0);
  std::error_code ignored;
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

}  // namespace demo
