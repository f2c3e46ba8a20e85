// SPDX-License-Identifier: Apache-2.0
#include "bench_robot.hpp"

#include <segue/base/descriptor.hpp>
#include <segue/base/file.hpp>
#include <segue/base/folders.hpp>
#include <segue/runtime/embedded_robot.hpp>

#include <cerrno>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include <fcntl.h>
#include <sys/file.h>

#include "output.hpp"

namespace segue::cli {

namespace {

namespace fs = std::filesystem;

constexpr const char* kRobotName = "segue-bench";
constexpr auto kBenchPatience = std::chrono::seconds(30);

/// Held as long as the robot exists; the system releases it even if this process crashes.
Result<Descriptor> take_lock() {
  const auto folder = runtime_folder();
  if (!folder) return folder.error();
  const fs::path file = *folder / (std::string(kRobotName) + ".lock");
  Descriptor lock(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600));
  if (!lock.valid()) return fail(ErrorCode::IoError, "cannot write " + file.string());
  if (::flock(lock.get(), LOCK_EX | LOCK_NB) == 0) return lock;
  return fail(ErrorCode::AlreadyExists, "another `segue bench` of yours is running; wait for its end");
}

/// A folder that the destructor removes.
class TemporaryFolder {
 public:
  TemporaryFolder() : path_((fs::temp_directory_path() / "segue-bench-XXXXXX").string()) {
    if (::mkdtemp(path_.data()) == nullptr) path_.clear();
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  [[nodiscard]] fs::path path() const { return path_; }

 private:
  std::string path_;
};

Error first_error(const Diagnostics& diagnostics) {
  for (const Diagnostic& diagnostic : diagnostics.items()) {
    if (diagnostic.severity == Severity::Error) return fail(ErrorCode::InvalidArgument, diagnostic.message);
  }
  return fail(ErrorCode::Internal, "the robot of the benchmark could not be opened");
}

class EmbeddedBenchRobot final : public BenchRobot {
 public:
  static Result<std::unique_ptr<BenchRobot>> make(Placement placement, model::Order order) {
    auto made = std::unique_ptr<EmbeddedBenchRobot>(new EmbeddedBenchRobot(order));
    auto lock = take_lock();
    if (!lock) return lock.error();
    made->lock_ = std::move(*lock);
    if (auto opened = made->open(placement); !opened) return opened.error();
    // Removes what an earlier run left when it was killed.
    if (auto empty = made->switch_to({}); !empty) return empty.error();
    return std::unique_ptr<BenchRobot>(std::move(made));
  }

  ~EmbeddedBenchRobot() override {
    if (robot_ == nullptr) return;
    const auto result = robot_->shut_down();
    if (result.error) print_note("the benchmark's robot did not stop cleanly: " + to_string(*result.error));
  }

  Result<double> switch_to(const model::Network& network) override {
    const auto begin = RealClock::instance().now();
    const auto result = robot_->runtime().switch_to(network, options_);
    const auto end = RealClock::instance().now();
    if (result.outcome == runtime::Outcome::Done) return std::chrono::duration<double>(end - begin).count();
    if (result.error) return *result.error;
    return fail(ErrorCode::Internal, "a switch was " + std::string(to_string(result.outcome)));
  }

  Result<void> wait_for_samples() override {
    const auto before = statistic("count");
    if (!before) return before.error();
    const auto deadline = RealClock::instance().now() + kBenchPatience;
    // The first new sample may have been under way already; the second was sent after the call.
    for (auto now = before; RealClock::instance().now() < deadline; now = statistic("count")) {
      if (!now) return now.error();
      if (*now >= *before + 2) return {};
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return fail(ErrorCode::DeadlineExceeded, "no sample came through the chain within 30 s");
  }

  Result<void> watch_gap() override {
    const auto done = call("reset");
    if (!done) return done.error();
    return {};
  }

  Result<double> longest_gap() override { return statistic("pause_max"); }

 private:
  explicit EmbeddedBenchRobot(model::Order order) { options_.order = order; }

  Result<void> open(Placement placement) {
    std::ofstream(folder_.path() / "robot.yaml")
        << "robot: " << kRobotName << "\nhosts: {localhost: local}\nlibraries: [segue_components_bench]\n";
    Diagnostics diagnostics;
    runtime::EmbeddedOptions options;
    options.placement = placement == Placement::OneProcess ? runtime::TaskPlacement::InProcess
                                                           : runtime::TaskPlacement::Processes;
    options.log_level = LogLevel::Error;
    robot_ = runtime::EmbeddedRobot::open(folder_.path() / "robot.yaml", diagnostics, options);
    if (robot_ == nullptr) return first_error(diagnostics);
    return {};
  }

  Result<type::Value> call(const char* operation) {
    return robot_->runtime().host().call(model::TaskId("consumer"), operation, type::Value(type::ValueMap{}),
                                         RealClock::instance().now() + kBenchPatience);
  }

  Result<double> statistic(const char* name) {
    const auto statistics = call("statistics");
    if (!statistics) return statistics.error();
    return number_at(*statistics, name);
  }

  runtime::RequestOptions options_;
  Descriptor lock_;
  TemporaryFolder folder_;
  std::unique_ptr<runtime::EmbeddedRobot> robot_;
};

}  // namespace

Result<std::unique_ptr<BenchRobot>> make_bench_robot(Placement placement, model::Order order) {
  return EmbeddedBenchRobot::make(placement, order);
}

}  // namespace segue::cli
