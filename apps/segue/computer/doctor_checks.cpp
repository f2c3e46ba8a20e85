// SPDX-License-Identifier: Apache-2.0
#include <segue/base/diagnostic.hpp>
#include <segue/base/folders.hpp>
#include <segue/base/rounded_text.hpp>
#include <segue/base/text.hpp>
#include <segue/base/unix_socket.hpp>
#include <segue/control/server.hpp>
#include <segue/journal/journal.hpp>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/timex.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "../connection.hpp"
#include "../models.hpp"
#include "doctor_checks.hpp"

namespace segue::cli {

namespace {

namespace fs = std::filesystem;

/// Less is not enough for the samples and logs of a robot.
constexpr std::uintmax_t kLeastSpace = 100'000'000;
constexpr rlim_t kFewFiles = 1024;

/// The first line; empty where there is none.
std::string line_of(const fs::path& file) {
  std::string line;
  std::ifstream stream(file);
  std::getline(stream, line);
  return line;
}

Finding check_real_time() {
  Finding found{"real-time scheduling"};
  bool permitted = false;
  std::thread([&] {
    sched_param parameters{};
    parameters.sched_priority = 1;
    permitted = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters) == 0;
  }).join();
  rlimit limit{};
  ::getrlimit(RLIMIT_RTPRIO, &limit);
  if (permitted) {
    const bool is_limited = limit.rlim_cur != 0 && limit.rlim_cur != RLIM_INFINITY;
    found.what = is_limited ? fmt::format("permitted, priorities up to {}", limit.rlim_cur) : "permitted";
    return found;
  }
  found.health = Health::Advice;
  found.what =
      "not permitted: tasks with the schedulers fifo and round_robin are refused, or run as normal where "
      "optional";
  found.mend =
      "echo \"$USER - rtprio 80\" | sudo tee /etc/security/limits.d/segue.conf    # then log in anew";
  return found;
}

Finding check_kernel() {
  Finding found{"kernel"};
  utsname name{};
  ::uname(&name);
  const bool is_real_time = line_of("/sys/kernel/realtime") == "1" ||
                            std::string_view(name.version).find("PREEMPT_RT") != std::string_view::npos;
  found.what = fmt::format(
      "Linux {}{}", name.release,
      is_real_time ? ", PREEMPT_RT" : ", without PREEMPT_RT: other programs may delay tasks by milliseconds");
  return found;
}

/// Where processors save power, an update takes longer after each sleep.
Finding check_processors() {
  Finding found{"processors"};
  const unsigned count = std::max(1U, std::thread::hardware_concurrency());
  std::array<double, 1> load{};
  const bool known = ::getloadavg(load.data(), 1) == 1;
  found.what = fmt::format("{}, load {:.1f}", count, known ? load[0] : 0.0);
  const std::string governor = line_of("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  if (!governor.empty() && governor != "performance") {
    found.health = Health::Advice;
    found.what += ", governor " + governor + ": they are slow after each rest";
    found.mend = "sudo cpupower frequency-set --governor performance";
  } else if (known && load[0] > count) {
    found.health = Health::Advice;
    found.what += ": more programs want to run than there are processors";
    found.mend = "top    # shows which";
  }
  return found;
}

Finding check_files() {
  Finding found{"open files"};
  rlimit limit{};
  ::getrlimit(RLIMIT_NOFILE, &limit);
  found.what = fmt::format("at most {} for each process", limit.rlim_cur);
  if (limit.rlim_cur >= kFewFiles) return found;
  found.health = Health::Advice;
  found.what += ": large robots need more";
  found.mend = fmt::format("ulimit -n {}", std::min<rlim_t>(limit.rlim_max, 4096));
  return found;
}

Finding check_space(const std::string& check, const fs::path& folder) {
  Finding found{check};
  std::error_code problem;
  const auto space = fs::space(folder, problem);
  if (problem) {
    found.health = Health::Bad;
    found.what = quote(folder.string()) + ": " + problem.message();
    return found;
  }
  found.what = format_quantity(static_cast<double>(space.available), "B") + " free in " + folder.string();
  if (space.available >= kLeastSpace) return found;
  found.health = Health::Bad;
  found.mend = "df -h " + folder.string() + "    # make room there";
  return found;
}

/// Of what a robot remembers: the nearest folder that is there.
Finding check_state() {
  auto folder = journal::default_path("robot");
  if (!folder) return {"state", Health::Bad, folder.error().message, "export HOME=FOLDER"};
  std::error_code ignored;
  while (!fs::exists(*folder, ignored) && folder->has_relative_path())
    *folder = folder->parent_path();
  return check_space("state", *folder);
}

Finding check_sockets() {
  Finding found{"folder of sockets"};
  const auto folder = runtime_folder();
  if (folder) {
    found.what = folder->string();
    return found;
  }
  found.health = Health::Bad;
  found.what = folder.error().message;
  found.mend = "export XDG_RUNTIME_DIR=/run/user/$(id -u)    # or another folder of your own";
  return found;
}

/// Robots on several computers compare times.
Finding check_clock() {
  Finding found{"clock"};
  timex state{};
  const bool is_synchronized = ::adjtimex(&state) != TIME_ERROR && (state.status & STA_UNSYNC) == 0;
  found.what = is_synchronized ? "synchronized"
                               : "not synchronized with other computers: matters for robots on several";
  if (is_synchronized) return found;
  found.health = Health::Advice;
  found.mend = "sudo timedatectl set-ntp true";
  return found;
}

Finding check_libraries() {
  Finding found{"component libraries"};
  Diagnostics diagnostics;
  const auto catalog = load_catalog({}, diagnostics);
  found.what = counted(catalog.size(), "component");
  for (const auto& diagnostic : diagnostics.items()) {
    found.health = Health::Bad;
    found.what = diagnostic.where.file + ": " + diagnostic.message;
    found.mend =
        "segue component list    # says all; build that library anew, or take it out of $SEGUE_LIBRARY_PATH";
    break;
  }
  return found;
}

bool answers(const fs::path& path) {
  const auto address = socket_address(path);
  const auto socket = new_socket();
  return address && socket && connect_once(socket->get(), *address) == 0;
}

/// The processes of a robot that live.
std::vector<std::string> deployments_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (entry.path().extension() == ".sock" && answers(entry.path()))
      names.push_back(entry.path().stem().string());
  }
  std::ranges::sort(names);
  return names;
}

/// Processes go on where the runtime of their robot was killed.
std::vector<Finding> check_leftovers(const std::vector<std::string>& robots) {
  std::vector<Finding> findings;
  const auto folder = runtime_folder();
  if (!folder) return findings;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(*folder, ignored)) {
    const std::string robot = entry.path().filename().string();
    if (!entry.is_directory(ignored) || std::ranges::count(robots, robot) > 0) continue;
    const auto left = deployments_in(entry.path());
    if (left.empty()) continue;
    findings.push_back({"processes left over", Health::Bad,
                        fmt::format("{} of robot {} {} without its runtime", fmt::join(left, ", "), robot,
                                    left.size() == 1 ? "runs" : "run"),
                        "segue run ROBOT_FILE    # takes them over, and Ctrl-C ends them"});
  }
  return findings;
}

Finding check_robot(const std::string& name) {
  Finding found{"robot " + name};
  const auto robot = connect_to(name);
  const auto status = robot ? (*robot)->status() : Result<type::Value>(robot.error());
  if (!status) {
    found.health = Health::Bad;
    found.what = status.error().message;
    found.mend = "segue log --help    # its output may say why";
    return found;
  }
  const auto* health = status->find("health");
  const std::string state = health == nullptr ? "unknown" : printable_at(*health, "state");
  found.what = state == "in_trouble" ? "in trouble" : state == "in_transition" ? "in transition" : state;
  if (state == "healthy" || state == "in_transition") return found;
  found.health = Health::Bad;
  found.mend =
      fmt::format("segue status --robot {0}    # says what is wrong; segue repair --robot {0}", name);
  return found;
}

}  // namespace

std::vector<Finding> examine_computer() {
  std::vector<Finding> findings = {check_real_time(),
                                   check_kernel(),
                                   check_processors(),
                                   check_files(),
                                   check_space("shared memory", "/dev/shm"),
                                   check_state(),
                                   check_sockets(),
                                   check_clock(),
                                   check_libraries()};
  const auto robots = control::running_robots();
  for (const std::string& name : robots)
    findings.push_back(check_robot(name));
  for (Finding& left : check_leftovers(robots))
    findings.push_back(std::move(left));
  return findings;
}

}  // namespace segue::cli
