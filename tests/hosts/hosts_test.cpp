// SPDX-License-Identifier: Apache-2.0
#include "hosts_test.hpp"

#include <segue/base/file.hpp>
#include <segue/distributed/gateways.hpp>
#include <segue/model/files.hpp>

#include <support/dds_domain.hpp>
#include <support/eventually.hpp>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <set>
#include <stdexcept>
#include <utility>

#include "../fault/processes.hpp"

namespace segue::testing {

namespace {

using type::Value;

std::string text(const Value& value, const char* key) {
  const Value* found = value.find(key);
  return found == nullptr || !found->is_string() ? std::string() : found->as_string();
}

using Lines = std::multiset<std::string>;

/// What is in only one of both, as sentences.
std::string difference(const std::string& what, const Lines& expected, const Lines& found) {
  std::string all;
  Lines missing;
  Lines extra;
  std::set_difference(expected.begin(), expected.end(), found.begin(), found.end(),
                      std::inserter(missing, missing.end()));
  std::set_difference(found.begin(), found.end(), expected.begin(), expected.end(),
                      std::inserter(extra, extra.end()));
  for (const auto& line : missing)
    all += what + " is missing: " + line + "\n";
  for (const auto& line : extra)
    all += what + " should not be there: " + line + "\n";
  return all;
}

Lines expected_tasks(const model::Network& network) {
  const auto processes = model::task_processes(network);
  Lines lines;
  for (const auto& task : network.tasks) {
    const auto process = processes.find(task.id);
    const std::string place = process == processes.end() ? "localhost/" : to_string(process->second);
    lines.insert(task.id.str() + " " + task.component.str() + " " + std::string(to_string(task.state)) +
                 " in " + place);
  }
  return lines;
}

Lines tasks_of(const Value& status) {
  Lines lines;
  for (const Value& task : status.find("tasks")->as_list()) {
    lines.insert(text(task, "id") + " " + text(task, "component") + " " + text(task, "state") + " in " +
                 text(task, "host") + "/" + text(task, "process"));
  }
  return lines;
}

Lines expected_connections(const model::Network& network) {
  Lines lines;
  for (const auto& one : network.connections) {
    lines.insert(to_string(one.from) + " -> " + to_string(one.to) + " " +
                 std::string(to_string(one.policy.kind)) + " " + std::to_string(one.policy.size));
  }
  return lines;
}

Lines connections_of(const Value& status) {
  Lines lines;
  for (const Value& one : status.find("connections")->as_list()) {
    lines.insert(text(one, "from") + " -> " + text(one, "to") + " " + text(one, "policy") + " " +
                 std::to_string(one.find("size")->as_uint()));
  }
  return lines;
}

/// "a/work" and its pid, of the processes that the runtime says tasks live in.
std::map<std::string, pid_t> pids_of(const Value& status) {
  std::map<std::string, pid_t> pids;
  for (const Value& task : status.find("tasks")->as_list()) {
    if (text(task, "process").empty()) continue;
    pids.emplace(text(task, "host") + "/" + text(task, "process"),
                 static_cast<pid_t>(task.find("pid")->as_int()));
  }
  return pids;
}

/// The processes that a network needs, with those of connections between hosts.
Lines expected_processes(const model::Network& network) {
  Lines names;
  std::set<std::string> used;
  const auto processes = model::task_processes(network);
  for (const auto& task : network.tasks) {
    const auto process = processes.find(task.id);
    used.insert(process == processes.end() ? "localhost" : process->second.host.str());
  }
  for (const auto& deployment : network.deployments)
    names.insert(to_string(deployment.key()));
  for (const auto& host : used) {
    if (used.size() > 1) names.insert(host + "/" + distributed::kGatewayProcess.str());
  }
  return names;
}

bool is_below(const std::string& environment, const std::string& folder) {
  return environment.find("XDG_RUNTIME_DIR=" + folder) != std::string::npos;
}

/// Whether there was any.
bool kill_those_below(const std::string& folder) {
  bool found = false;
  std::error_code gone;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", gone)) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos || name == std::to_string(::getpid()))
      continue;
    if (!is_below(read_file(entry.path() / "environ").value_or(""), folder)) continue;
    found = ::kill(std::stoi(name), SIGKILL) == 0 || found;
  }
  return found;
}

}  // namespace

Guardian::Guardian(std::string folder) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("pipe2");
  pid_ = ::fork();
  if (pid_ == 0) {
    ::setsid();  // it outlives what kills the test
    ::close(ends[1]);
    char byte = 0;
    while (::read(ends[0], &byte, 1) > 0) {
    }
    (void)eventually([&] { return !kill_those_below(folder); });  // until none starts others any more
    ::_exit(0);
  }
  ::close(ends[0]);
  end_ = ends[1];
}

Guardian::~Guardian() {
  ::close(end_);
  ::waitpid(pid_, nullptr, 0);
}

void HostsTest::SetUp() {
  SystemTest::SetUp();
  // Forked before there is a runtime folder in the environment: the guardian is none of the processes.
  guardian_ = std::make_unique<Guardian>(folder_.string());
  // Robots of tests have names of their own, too, so that samples never get from one test to another.
  ::setenv("ROS_DOMAIN_ID", std::to_string(segue::testing::dds_domain_of_process()).c_str(), 1);
  robot_name_ = "r" + std::to_string(::getpid());
}

void HostsTest::TearDown() {
  if (HasFailure() && runtime_) std::fprintf(stderr, "runtime: %s\n", runtime_->output().c_str());
  if (runtime_) stop_robot();
  for (const auto& [name, host] : hosts_) {
    host->thaw();
    for (const auto& [process, pid] : host->deployments())
      ADD_FAILURE() << process << " is left on host " << name;
  }
  if (HasFailure()) {
    for (const auto& [name, host] : hosts_)
      std::fprintf(stderr, "host %s: %s\n", name.c_str(), host->output().c_str());
  }
  hosts_.clear();
  guardian_.reset();
  SystemTest::TearDown();
}

Surroundings HostsTest::surroundings_of(const std::string& /*host*/) {
  return {};
}

void HostsTest::make_hosts(const std::vector<std::string>& names) {
  for (const auto& name : names) {
    auto& host = hosts_[name];
    host = std::make_unique<TestHost>(name, folder_, surroundings_of(name));
    host->start();
  }
}

void HostsTest::write_robot(const std::string& more, const std::vector<std::string>& optional_hosts) const {
  std::string file = "robot: " + robot_name_ + "\nhosts:\n";
  for (const auto& [name, host] : hosts_) {
    const bool optional =
        std::find(optional_hosts.begin(), optional_hosts.end(), name) != optional_hosts.end();
    file += "  " + name + ": {address: \"" + host->address() + "\"" + (optional ? ", optional: true" : "");
    if (!host->credentials().empty()) file += ", credentials: \"" + host->credentials() + "\"";
    file += "}\n";
  }
  write("robot/robot.yaml", file + "controllers: [\"*.net\"]\n" + more);
}

std::unique_ptr<LoggedProcess> HostsTest::run_robot(const std::string& runtime_folder,
                                                    const std::vector<std::string>& options) const {
  std::vector<std::string> arguments = {"run", "robot/robot.yaml", "--no-journal"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  std::filesystem::create_directories(folder_ / runtime_folder);
  auto whole = runtime_launcher();
  for (auto& word : command(std::move(arguments)))
    whole.push_back(std::move(word));
  return std::make_unique<LoggedProcess>(
      whole, folder_, folder_ / (runtime_folder + "." + std::to_string(runs_) + ".log"),
      std::map<std::string, std::string>{{"XDG_RUNTIME_DIR", (folder_ / runtime_folder).string()}});
}

void HostsTest::start_robot(const std::vector<std::string>& options) {
  ++runs_;
  runtime_ = run_robot("runtime", options);
  if (!runtime_->wait_for("robot " + robot_name_ + " runs")) {
    throw std::runtime_error("the robot does not start: " + std::exchange(runtime_, nullptr)->output());
  }
}

void HostsTest::stop_robot() {
  runtime_->signal(SIGINT);
  EXPECT_EQ(runtime_->wait(), 0) << runtime_->output();
  runtime_.reset();
}

void HostsTest::kill_runtime() {
  runtime_->signal(SIGKILL);
  EXPECT_EQ(runtime_->wait(), 128 + SIGKILL);
  runtime_.reset();
}

Value HostsTest::switch_to(const std::string& controller, const std::string& outcome) {
  const auto result = json({"switch", controller}, outcome == "done" ? 0 : 1);
  EXPECT_EQ(text(result, "outcome"), outcome) << controller << ": " << type::to_json(result);
  return result;
}

bool HostsTest::recover_to(const std::string& controller) {
  const auto wanted = network(controller);
  std::string wrong;
  const bool done = eventually([&] {
    (void)segue({"switch", controller});
    return (wrong = what_is_wrong(wanted)).empty();
  });
  EXPECT_TRUE(done) << wrong;
  return done;
}

std::string HostsTest::what_is_wrong(const model::Network& network) {
  const auto finished = segue({"status", "--format", "json"});
  const auto now = type::parse_json(finished.output);
  if (finished.status != 0 || !now) return finished.errors;
  std::string wrong;
  if (text(*now, "controller") != network.name.str())
    wrong += "controller: " + text(*now, "controller") + "\n";
  for (const char* key : {"differences", "ended", "unresolved"}) {
    const Value& list = *now->find(key);
    if (!list.as_list().empty()) wrong += std::string(key) + ": " + type::to_json(list) + "\n";
  }
  wrong += difference("task", expected_tasks(network), tasks_of(*now));
  wrong += difference("connection", expected_connections(network), connections_of(*now));
  const auto processes = all_deployments();
  Lines names;
  for (const auto& [name, pid] : processes)
    names.insert(name);
  wrong += difference("process", expected_processes(network), names);
  for (const auto& [name, pid] : pids_of(*now)) {
    const auto found = processes.find(name);
    if (found != processes.end() && found->second != pid)
      wrong += name + " has pid " + std::to_string(found->second) + ", not " + std::to_string(pid) + "\n";
  }
  return wrong;
}

std::string HostsTest::what_stays_wrong(const model::Network& network) {
  std::string wrong;
  (void)eventually([&] { return (wrong = what_is_wrong(network)).empty(); });
  return wrong;
}

model::Network HostsTest::network(const std::string& name) const {
  Diagnostics diagnostics;
  auto loaded = model::load_network(folder_ / "robot" / (name + ".net"), diagnostics);
  EXPECT_TRUE(loaded) << to_string(diagnostics);
  return loaded.value_or(model::Network{});
}

Value HostsTest::host_status(const std::string& name) {
  const auto now = status();
  for (const Value& host : now.find("hosts")->as_list()) {
    if (text(host, "name") == name) return host;
  }
  ADD_FAILURE() << "the robot has no host " << name;
  return {};
}

bool HostsTest::wait_until_reachable(const std::string& host, bool reachable) {
  return eventually([&] { return *host_status(host).find("reachable") == Value(reachable); });
}

std::int64_t HostsTest::last_event() {
  const auto events = json({"events"});
  return events.as_list().empty() ? 0 : events.as_list().back().find("number")->as_int();
}

void HostsTest::expect_event(const std::string& kind, const std::string& words, std::int64_t after) {
  const bool came = eventually([&] {
    const auto events = json({"events", "--after", std::to_string(after)});
    return std::any_of(events.as_list().begin(), events.as_list().end(), [&](const Value& event) {
      return text(event, "kind") == kind &&
             (text(event, "subject") + ": " + text(event, "message")).find(words) != std::string::npos;
    });
  });
  EXPECT_TRUE(came) << "no event '" << kind << "' with '" << words << "'\n" << segue({"events"}).output;
}

std::map<std::string, pid_t> HostsTest::all_deployments() const {
  std::map<std::string, pid_t> all;
  const auto add = [&](const std::string& host, const std::map<std::string, pid_t>& processes) {
    for (const auto& [name, pid] : processes)
      all.emplace(host + "/" + name, pid);
  };
  for (const auto& [name, host] : hosts_)
    add(name, host->deployments());
  add("localhost", deployments_of(folder_ / "runtime"));
  return all;
}

}  // namespace segue::testing
