// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/temporary_hosts.hpp>

#include <segue/base/child_process.hpp>
#include <segue/base/clock.hpp>
#include <segue/base/file.hpp>
#include <segue/base/pipe.hpp>
#include <segue/base/text.hpp>
#include <segue/model/files.hpp>

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <utility>

namespace segue::runtime {

namespace fs = std::filesystem;

namespace {

constexpr int kDomains = 230;  // of DDS
constexpr auto kPatience = std::chrono::seconds(30);

fs::path runtime_folder_of(const fs::path& folder, const std::string& host) {
  return folder / host / "run";
}

/// Waits for the first line of a daemon.
Result<void> wait_until_it_serves(int output, const std::string& name) {
  const auto deadline = RealClock::instance().now() + kPatience;
  for (char next = '\0'; next != '\n';) {
    if (!wait_for_input(output, deadline))
      return fail(ErrorCode::DeadlineExceeded, "it does not start", name);
    if (::read(output, &next, 1) <= 0) return fail(ErrorCode::Unavailable, "it has ended at once", name);
  }
  return {};
}

/// A configuration of its own, since that of this user may name addresses to listen at.
Result<fs::path> write_configuration(const fs::path& folder, const std::string& name) {
  std::error_code failed;  // writing the file says what is wrong
  fs::create_directories(runtime_folder_of(folder, name), failed);
  const fs::path file = folder / name / "host.yaml";
  const auto written =
      write_file(file, "name: " + name + "\nstate: " + quote((folder / name / "state").string()) + "\n");
  if (!written) return written.error();
  return file;
}

fs::path program_beside_this() {
  std::error_code unknown;
  return fs::read_symlink("/proc/self/exe", unknown).parent_path() / "segue";
}

}  // namespace

TemporaryHosts::~TemporaryHosts() {
  for (Daemon& daemon : daemons_)
    daemon.input = Descriptor();
  for (const Daemon& daemon : daemons_)
    wait_for_end(daemon.pid, kPatience);
  std::error_code ignored;
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

Result<void> TemporaryHosts::start(const std::vector<TemporaryHost>& hosts, const fs::path& program) {
  std::string pattern = (fs::temp_directory_path() / "segue-hosts-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) return system_error("cannot create the folder " + pattern, errno);
  folder_ = pattern;
  ::setenv("ROS_DOMAIN_ID", std::to_string(1 + ::getpid() % kDomains).c_str(), 0);
  for (const TemporaryHost& host : hosts) {
    if (auto started = start_daemon(host, program.empty() ? program_beside_this() : program); !started) {
      return started;
    }
  }
  for (const Daemon& daemon : daemons_) {
    if (auto serves = wait_until_it_serves(daemon.output.get(), "host " + daemon.name); !serves)
      return serves;
  }
  return {};
}

Result<void> TemporaryHosts::start_daemon(const TemporaryHost& host, const fs::path& program) {
  const auto configuration = write_configuration(folder_, host.name);
  if (!configuration) return configuration.error();
  auto input = make_pipe();
  if (!input) return std::move(input.error());
  auto output = make_pipe();
  if (!output) return std::move(output.error());
  ChildProcess child(3);
  const std::pair<int, int> given[] = {{input->read.get(), STDIN_FILENO},
                                       {output->write.get(), STDOUT_FILENO},
                                       {STDERR_FILENO, STDERR_FILENO}};
  for (const auto& [source, number] : given) {
    if (auto handed = child.hand_over(source, number); !handed) return handed;
  }
  child.set_environment({{"XDG_RUNTIME_DIR", runtime_folder_of(folder_, host.name).string()}});
  std::vector<std::string> words = host.launcher;
  for (const std::string& word : {program.string(), std::string("host"), std::string("--until-eof"),
                                  std::string("--config"), configuration->string()}) {
    words.push_back(word);
  }
  words.insert(words.end(), host.options.begin(), host.options.end());
  const std::string first = words.front();
  auto pid = child.start(first, std::move(words), "host " + host.name + ": ");
  if (!pid) return std::move(pid.error());
  daemons_.push_back({host.name, *pid, std::move(input->write), std::move(output->read)});
  return {};
}

std::string TemporaryHosts::address(const std::string& host) const {
  return "unix:" + (runtime_folder_of(folder_, host) / "segue" / "@host.sock").string();
}

void deal_out(model::Network& network, const std::vector<std::string>& hosts) {
  for (model::Deployment& deployment : network.deployments) {
    std::uint32_t hash = 2166136261U;  // FNV-1a
    for (const char c : deployment.process.str())
      hash = (hash ^ static_cast<unsigned char>(c)) * 16777619U;
    deployment.host = model::HostName(hosts[hash % hosts.size()]);
  }
}

Result<fs::path> deal_out(const fs::path& robot_file, const HostEntries& hosts, const fs::path& folder) {
  Diagnostics diagnostics;
  const auto robot = model::load_robot(robot_file, diagnostics);
  if (!robot) return diagnostics.to_error();
  std::error_code failed;
  fs::create_directories(folder, failed);  // writing the files says what is wrong
  std::string text = "robot: " + robot->name + "\ncontrollers: [\"*.net\"]\nhosts:\n";
  std::vector<std::string> names;
  for (const auto& [name, entry] : hosts) {
    text.append("  ").append(name).append(": ").append(entry).append("\n");
    names.push_back(name);
  }
  if (auto written = write_file(folder / "robot.yaml", text); !written) return written.error();
  for (const auto& controllers : robot->controllers) {
    for (const auto& file : glob_files(robot->folder / controllers)) {
      auto network = model::load_network(file, diagnostics);
      if (!network) return diagnostics.to_error();
      deal_out(*network, names);
      const auto written =
          write_file(folder / (network->name.str() + ".net"), model::write_network(*network));
      if (!written) return written.error();
    }
  }
  return folder / "robot.yaml";
}

}  // namespace segue::runtime
