// SPDX-License-Identifier: Apache-2.0
// Hosts that a program starts for itself end with it, and take everything along that runs there.
#include <segue/base/question.hpp>
#include <segue/runtime/embedded_robot.hpp>
#include <segue/runtime/served_runtime.hpp>
#include <segue/runtime/temporary_hosts.hpp>

#include <support/eventually.hpp>

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>

#include "../fault/processes.hpp"
#include "../system/system_test.hpp"

namespace segue::testing {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNetwork = R"(network: one
tasks: {relay: {component: bench::Relay}}
deployments: {work: {host: a, tasks: [relay]}}
)";

class TemporaryHosts : public SystemTest {
 protected:
  static Result<void> start(runtime::TemporaryHosts& hosts) {
    return hosts.start({{"a"}, {"b"}}, segue::paths::kProgram);
  }
  static fs::path runtime_folder(const fs::path& folder, const char* host) { return folder / host / "run"; }
  static std::size_t processes(const fs::path& folder) {
    return processes_of(runtime_folder(folder, "a")).size() +
           processes_of(runtime_folder(folder, "b")).size();
  }

  static void write_robot(const runtime::TemporaryHosts& hosts, const std::string& more) {
    std::ofstream(hosts.folder() / "robot.yaml")
        << "robot: short_lived\nhosts: {a: \"" << hosts.address("a") << "\", b: \"" << hosts.address("b")
        << "\"}\nlibraries: [segue_components_bench]\n"
        << more;
  }

  /// A robot with a process on host a; nothing, with the reason on standard error, where that is not
  /// possible.
  static std::optional<runtime::EmbeddedRobot> run_robot(const runtime::TemporaryHosts& hosts) {
    std::ofstream(hosts.folder() / "one.yaml") << kNetwork;
    write_robot(hosts, "controllers: [one.yaml]\n");
    runtime::EmbeddedOptions options;
    options.placement = runtime::TaskPlacement::Processes;
    auto robot = runtime::EmbeddedRobot::open(hosts.folder() / "robot.yaml", options);
    if (!robot) {
      std::fputs(to_string(robot.error()).c_str(), stderr);
      return std::nullopt;
    }
    const auto result = robot->switch_to("one");
    if (result.ok()) return std::move(*robot);
    std::fputs(result.why().c_str(), stderr);
    return std::nullopt;
  }

  /// In a process of its own: hosts with a robot, until that process is killed. Writes their folder.
  [[noreturn]] static void run_until_killed(int output) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    runtime::TemporaryHosts hosts;
    std::optional<runtime::EmbeddedRobot> robot;
    if (start(hosts)) robot = run_robot(hosts);
    if (robot) {
      const std::string folder = hosts.folder();
      [[maybe_unused]] const auto written = ::write(output, folder.data(), folder.size());
    }
    ::close(output);
    for (;;)
      ::pause();
  }
};

TEST_F(TemporaryHosts, EndWithTheObjectWhateverRunsThere) {
  fs::path folder;
  {
    runtime::TemporaryHosts hosts;
    const auto started = start(hosts);
    ASSERT_TRUE(started) << to_string(started.error());
    folder = hosts.folder();
    const auto robot = run_robot(hosts);
    ASSERT_TRUE(robot);
    EXPECT_EQ(deployments_of(runtime_folder(folder, "a")).size(), 1U);
  }
  EXPECT_EQ(processes(folder), 0U);
  EXPECT_FALSE(fs::exists(folder));
}

TEST_F(TemporaryHosts, HoldInstancesOfPoolsWhileCallsNeedThem) {
  runtime::TemporaryHosts hosts;
  const auto started = start(hosts);
  ASSERT_TRUE(started) << to_string(started.error());
  write_robot(
      hosts, "pools: {relay: {component: bench::Relay, size: 0..2, idle_after: 10ms, process: {host: a}}}\n");
  runtime::EmbeddedOptions options;
  options.placement = runtime::TaskPlacement::Processes;
  auto robot = runtime::EmbeddedRobot::open(hosts.folder() / "robot.yaml", options);
  ASSERT_TRUE(robot) << to_string(robot.error());
  auto& runtime = robot->runtime().served();
  const auto on_a = [&] { return deployments_of(runtime_folder(hosts.folder(), "a")).size(); };
  EXPECT_EQ(on_a(), 0U);
  for (std::size_t count = 1; count <= 2; ++count) {
    const auto taken =
        answer_to<model::TakenInstance>(RealClock::instance().now() + std::chrono::minutes(1),
                                        [&](const Wait& wait, model::InstanceAnswer answer) {
                                          runtime.take_instance({"relay"}, wait, std::move(answer));
                                        });
    ASSERT_TRUE(taken) << to_string(taken.error());
    EXPECT_TRUE(eventually([&] { return on_a() == count; })) << "each keeps its instance for a while";
  }
  EXPECT_TRUE(deployments_of(runtime_folder(hosts.folder(), "b")).empty());
  EXPECT_TRUE(eventually([&] { return on_a() == 0; })) << "nobody has called them";
}

TEST_F(TemporaryHosts, EndWithAProgramThatIsKilled) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(ends[0]);
    run_until_killed(ends[1]);
  }
  ::close(ends[1]);
  std::array<char, 4096> text{};
  const ssize_t size = ::read(ends[0], text.data(), text.size());  // it has a deadline for each step
  ::close(ends[0]);
  const fs::path folder = std::string(text.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
  EXPECT_NE(folder, "") << "no robot runs";
  EXPECT_GE(processes(folder), 3U) << "two daemons and a deployment";
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_TRUE(eventually([&] { return processes(folder) == 0; }));
  if (!folder.empty()) fs::remove_all(folder);
}

TEST_F(TemporaryHosts, ADaemonThatDoesNotStartIsAnError) {
  runtime::TemporaryHosts hosts;
  const auto started = hosts.start({{"a", {}, {"--listen", "no address at all"}}}, segue::paths::kProgram);
  ASSERT_FALSE(started);
  EXPECT_EQ(to_string(started.error()), "host a: it has ended at once");
}

TEST_F(TemporaryHosts, AProgramThatIsMissingIsAnError) {
  runtime::TemporaryHosts hosts;
  const auto started = hosts.start({{"a"}}, folder_ / "missing");
  ASSERT_FALSE(started);
  EXPECT_NE(to_string(started.error()).find("cannot start host a"), std::string::npos)
      << to_string(started.error());
}

}  // namespace
}  // namespace segue::testing
