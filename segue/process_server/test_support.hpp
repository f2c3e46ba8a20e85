// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/condition_variable.hpp>
#include <segue/base/file.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/text.hpp>
#include <segue/process_server/process_log.hpp>
#include <segue/process_server/process_server.hpp>

#include <support/eventually.hpp>
#include <support/paths.hpp>
#include <support/sanitizers.hpp>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <thread>

namespace segue::process_server {

namespace fs = std::filesystem;
using segue::testing::eventually;
using segue::testing::kPatience;
using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::HasSubstr;

inline TimePoint soon(Duration duration = kPatience) {
  return RealClock::instance().now() + duration;
}

/// A zombie counts as gone.
inline bool lives(int pid) {
  const auto status = read_file("/proc/" + std::to_string(pid) + "/stat");
  if (!status) return false;
  const auto name_end = status->rfind(')');
  return name_end != std::string::npos && status->size() > name_end + 2 && (*status)[name_end + 2] != 'Z';
}

/// Records the events of a listener.
class Heard {
 public:
  void hear(const ProcessInfo& process) {
    const Lock lock(mutex_);
    told_.push_back(process);
    changed_.notify_all();
  }
  /// The first event of that process.
  std::optional<ProcessInfo> end_of(const std::string& process) {
    Lock lock(mutex_);
    const auto find = [&] {
      return std::ranges::find_if(told_, [&](const auto& each) { return each.key.process.str() == process; });
    };
    if (!changed_.wait_for(mutex_, kPatience, [&] { return find() != told_.end(); })) return std::nullopt;
    return *find();
  }
  std::size_t count() {
    const Lock lock(mutex_);
    return told_.size();
  }

 private:
  Mutex mutex_;
  ConditionVariable changed_;
  std::vector<ProcessInfo> told_;
};

class ProcessServerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = "/tmp/segue-test-XXXXXX";
    folder_ = ::mkdtemp(pattern.data());
    ::setenv("XDG_RUNTIME_DIR", folder_.c_str(), 1);
  }

  void TearDown() override {
    for (const int pid : pids_)
      ::kill(-pid, SIGKILL);
    for (const int pid : pids_)
      EXPECT_TRUE(eventually([pid] { return !lives(pid); })) << pid;
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  static ProcessServerOptions options() {
    ProcessServerOptions options;
    options.program = segue::paths::kTestProcess;
    return options;
  }

  static Launch launch(const std::string& process, const std::string& what = "") {
    Launch launch;
    launch.robot = "rover";
    launch.deployment.process = model::ProcessName(process);
    if (!what.empty()) launch.deployment.environment.emplace_back("TEST_DO", what);
    return launch;
  }

  static model::DeploymentKey key(const std::string& process) {
    return {model::kLocalHost, model::ProcessName(process)};
  }

  static std::unique_ptr<ProcessServer> server(const ProcessServerOptions& chosen = options()) {
    auto made = ProcessServer::create(chosen);
    EXPECT_TRUE(made.has_value()) << (made ? "" : to_string(made.error()));
    return made ? std::move(*made) : nullptr;
  }

  /// Starts a process and waits until it handles signals.
  ProcessInfo started(ProcessServer& server, const Launch& what) {
    auto process = server.start(what, soon());
    EXPECT_TRUE(process.has_value()) << (process ? "" : to_string(process.error()));
    if (!process) return {};
    pids_.push_back(process->pid);
    return *process;
  }
  ProcessInfo ready(ProcessServer& server, const Launch& what) {
    const auto process = started(server, what);
    EXPECT_TRUE(eventually([&] { return text_of(process.log).find("ready\n") != std::string::npos; }))
        << text_of(process.log);
    return process;
  }

  static std::string text_of(const fs::path& file) { return read_file(file).value_or(""); }

  /// File names in the robot's folder.
  [[nodiscard]] std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_ / "segue" / "rover"))
      names.insert(entry.path().filename());
    return names;
  }

  fs::path folder_;
  std::vector<int> pids_;
};

}  // namespace segue::process_server
