// SPDX-License-Identifier: Apache-2.0
#include "bench_robot.hpp"

#include <segue/base/file.hpp>
#include <segue/base/folders.hpp>
#include <segue/base/text.hpp>
#include <segue/control/host_client.hpp>
#include <segue/model/robot.hpp>
#include <segue/runtime/host_places.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/task_host/task_host.hpp>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <optional>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>

#include "../output.hpp"

namespace segue::cli {

namespace {

namespace fs = std::filesystem;

constexpr const char* kRobotName = "segue-bench";
constexpr const char* kConsumer = "consumer";
constexpr auto kBenchPatience = std::chrono::seconds(30);

/// Held as long as the robot exists; the system releases it even if this process crashes.
Result<Descriptor> take_bench_lock() {
  const auto folder = runtime_folder();
  if (!folder) return folder.error();
  const fs::path file = *folder / (std::string(kRobotName) + ".lock");
  Descriptor lock(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600));
  if (!lock.valid()) return fail(ErrorCode::IoError, "cannot write " + file.string());
  if (::flock(lock.get(), LOCK_EX | LOCK_NB) == 0) return lock;
  return fail(ErrorCode::AlreadyExists, "another `segue bench` of yours is running; wait for its end");
}

TimePoint patience() {
  return RealClock::instance().now() + kBenchPatience;
}

}  // namespace

BenchRobot::BenchRobot() {
  std::string pattern = (fs::temp_directory_path() / "segue-bench-XXXXXX").string();
  if (::mkdtemp(pattern.data()) != nullptr) folder_ = pattern;
}

BenchRobot::~BenchRobot() {
  if (robot_) {
    const auto result = robot_->shut_down();
    if (!result.ok()) print_note("the benchmark's robot did not stop cleanly: " + result.why());
    robot_.reset();
  }
  std::error_code ignored;
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

Result<std::unique_ptr<BenchRobot>> BenchRobot::open(BenchTransport transport, const BenchHost& host) {
  auto robot = std::unique_ptr<BenchRobot>(new BenchRobot());
  auto lock = take_bench_lock();
  if (!lock) return lock.error();
  robot->lock_ = std::move(*lock);
  if (auto started = robot->start(transport, host); !started) return started.error();
  if (auto empty = robot->switch_to({}); !empty) return empty.error();
  return robot;
}

Result<std::string> BenchRobot::enter_host(const BenchHost& host) {
  std::string address = host.address;
  if (host.is_here()) {
    hosts_ = std::make_unique<runtime::TemporaryHosts>();
    // Like the robot in this process, it says nothing but errors.
    if (auto started = hosts_->start({{host.name, {}, {"--log-level", "error"}}}); !started)
      return started.error();
    address = hosts_->address(host.name);
  }
  std::string text = ", " + host.name + ": {address: " + quote(address);
  if (!host.credentials.empty()) text += ", credentials: " + quote(fs::absolute(host.credentials).string());
  return text + "}";
}

Result<void> BenchRobot::start(BenchTransport transport, const BenchHost& host) {
  const fs::path file = folder_ / "robot.yaml";
  const auto other = transport == BenchTransport::Remote ? enter_host(host) : Result<std::string>("");
  if (!other) return other.error();
  auto written = write_file(file, std::string("robot: ") + kRobotName + "\nhosts: {localhost: local" +
                                      *other + "}\nlibraries: [segue_components_bench]\n" +
                                      "look_ahead: {processes: 1000, memory: 100GB}\n");
  if (!written) return written;
  runtime::EmbeddedOptions options;
  options.placement = transport == BenchTransport::Local ? runtime::TaskPlacement::InProcess
                                                         : runtime::TaskPlacement::Processes;
  options.log_level = LogLevel::Error;
  auto opened = runtime::EmbeddedRobot::open(file, options);
  if (!opened) return opened.error();
  robot_.emplace(std::move(*opened));
  return {};
}

Result<std::vector<double>> BenchRobot::round_trips(std::size_t repetitions,
                                                    const std::function<bool()>& stopped) {
  const model::Robot& robot = robot_->robot();
  const auto there = std::ranges::find_if(robot.hosts, [](const auto& host) { return !host.is_local(); });
  if (there == robot.hosts.end()) return std::vector<double>{};
  const auto endpoint = runtime::endpoint_of(robot, *there);
  if (!endpoint) return endpoint.error();
  const auto daemon = control::connect_host(*endpoint, patience(), [] {});
  if (!daemon) return daemon.error();
  std::vector<double> durations;
  for (std::size_t i = 0; i < repetitions && !stopped(); ++i) {
    const auto begin = RealClock::instance().now();
    if (auto answered = (*daemon)->clock(); !answered) return answered.error();
    durations.push_back(std::chrono::duration<double>(RealClock::instance().now() - begin).count());
  }
  return durations;
}

Result<Switched> BenchRobot::request(runtime::Request request, model::Order order) {
  runtime::RequestOptions options;
  options.order = order;
  const auto begin = RealClock::instance().now();
  auto result = robot_->runtime().switch_to(std::move(request), options);
  const auto end = RealClock::instance().now();
  if (result.ok()) {
    return Switched{std::chrono::duration<double>(end - begin).count(), std::move(result.actions)};
  }
  return result.error.value_or(fail(ErrorCode::Internal, "a switch: " + result.why()));
}

Result<Switched> BenchRobot::switch_to(const model::Network& network, model::Order order) {
  return request(network, order);
}

Result<void> BenchRobot::prepare(const model::Network& running, const model::Network& next) {
  runtime::Runtime& runtime = robot_->runtime();
  for (const model::Network* network : {&running, &next}) {
    if (const auto problems = runtime.add_controller(*network); problems.has_errors())
      return problems.to_error();
  }
  const auto readiness = runtime.prepare({next.name, running.name}).get();
  if (!readiness.empty() && readiness.front().ready) return {};
  return fail(ErrorCode::ResourceExhausted, "the other chain could not be prepared: " +
                                                (readiness.empty() ? "" : readiness.front().reason));
}

void BenchRobot::drop_prepared() {
  robot_->runtime().prepare({}).wait();
}

Result<Switched> BenchRobot::call_by_transition(const std::string& task, const std::string& operation) {
  model::Transition transition;
  transition.from = transition.to = robot_->runtime().belief().name;
  model::Action action;
  action.id = 1;
  action.kind = model::ActionKind::CallOperation;
  action.what = model::CallAction{model::TaskId(task), operation, type::Value(type::ValueMap{})};
  transition.actions.push_back(std::move(action));
  return request(std::move(transition), model::Order::Paper);
}

Result<type::Value> BenchRobot::call(const std::string& task, const char* operation) {
  return robot_->runtime().host().call(model::TaskId(task), operation, type::Value(type::ValueMap{}),
                                       patience());
}

Result<void> BenchRobot::make_fail(const std::string& relay) {
  const auto called = call(relay, "fail");
  if (!called) return called.error();
  for (const auto deadline = patience(); RealClock::instance().now() < deadline;) {
    const model::Network observed = robot_->runtime().host().observe();
    const model::Task* task = observed.find_task(model::TaskId(relay));
    if (task != nullptr && task->state == TaskState::RunTimeError) return {};
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return fail(ErrorCode::DeadlineExceeded, "the task " + relay + " did not fail within 30 s");
}

Result<double> BenchRobot::statistic(const char* name) {
  const auto statistics = call(kConsumer, "statistics");
  if (!statistics) return statistics.error();
  return number_at(*statistics, name);
}

Result<void> BenchRobot::wait_for_samples() {
  const auto before = statistic("count");
  if (!before) return before.error();
  // The first new sample may have been under way already; the second was sent after the call.
  const double enough = *before + 2;
  return wait_for_count(static_cast<std::size_t>(enough), [] { return false; });
}

Result<void> BenchRobot::wait_for_count(std::size_t samples, const std::function<bool()>& stopped) {
  std::optional<double> last;
  for (auto deadline = patience(); RealClock::instance().now() < deadline && !stopped();) {
    const auto count = statistic("count");
    if (!count) return count.error();
    if (*count >= static_cast<double>(samples)) return {};
    if (last != *count) deadline = patience();
    last = *count;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  if (stopped()) return {};
  return fail(ErrorCode::DeadlineExceeded, "no sample came through the chain within 30 s");
}

}  // namespace segue::cli
