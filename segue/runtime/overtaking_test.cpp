// SPDX-License-Identifier: Apache-2.0
//
// Requests of many clients that overtake each other, on networks that move tasks between processes, and
// processes that die in between. Each request ends done or superseded, or fails because a process died; the
// robot always gets to what is requested last, and nothing is left over.
//
// SEGUE_REQUESTS sets the number of requests of each test, SEGUE_SEED the seed.
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/fleet/deployed_task_host.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/runtime_options.hpp>
#include <segue/task_host/component_library.hpp>
#include <segue/task_host/local_task_host.hpp>

#include <support/eventually.hpp>
#include <support/fake_world.hpp>
#include <support/sanitizers.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <future>
#include <map>
#include <random>
#include <string>
#include <thread>
#include <vector>

namespace segue::runtime {
namespace {

using namespace std::chrono_literals;
using Random = std::mt19937_64;

std::uint64_t setting(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

constexpr std::uint64_t kRequests = kSanitized ? 1000 : 5000;
constexpr int kControllers = 12;
constexpr std::uint64_t kMostClients = 4;
constexpr int kRequestsARound = 25;                ///< of each client
constexpr std::uint64_t kCallsBetweenDeaths = 25;  ///< at the most

model::NetworkName controller_name(std::uint64_t number) {
  return model::NetworkName("controller" + std::to_string(number));
}

/// Some of six tasks, each in any of three processes or in the runtime's, connected in a row.
model::Network random_controller(Random& random, int number) {
  model::Network network;
  network.name = controller_name(static_cast<std::uint64_t>(number));
  std::map<std::string, model::Deployment> processes;
  for (const char* id : {"a", "b", "c", "d", "e", "f"}) {
    if (random() % 6 == 0) {
      continue;
    }
    model::Task task;
    task.id = model::TaskId(id);
    task.component = model::ComponentName(random() % 8 == 0 ? "test::Other" : "test::Usual");
    task.properties = type::Value::map({{"gain", static_cast<std::int64_t>(random() % 2)}});
    task.state = random() % 5 == 0 ? TaskState::Stopped : TaskState::Running;
    if (random() % 3 == 0) {
      task.takes_over = task.id;
    }
    const std::uint64_t place = random() % 4;
    if (place > 0) {
      const std::string name = "p" + std::to_string(place);
      processes[name].process = model::ProcessName(name);
      processes[name].tasks.push_back({task.id, id});
    }
    if (!network.tasks.empty()) {
      model::Connection connection;
      connection.from = {network.tasks.back().id, "out"};
      connection.to = {task.id, "in"};
      network.connections.push_back(connection);
    }
    network.tasks.push_back(std::move(task));
  }
  for (auto& [name, deployment] : processes) {
    network.deployments.push_back(std::move(deployment));
  }
  return network;
}

/// A runtime over simulated processes, whose calls let others go first now and then.
class Robot {
 public:
  explicit Robot(std::uint64_t seed) : random_(seed) {
    world.on_call([this](const std::string&, const deploy::testing::FakePtr&) {
      if (random_below(4) == 0) {
        std::this_thread::yield();
      }
      if (note_call()) {
        kill_some_process();
      }
    });
    Random shapes(seed);
    for (int i = 0; i < kControllers; ++i) {
      const Diagnostics findings = runtime.add_controller(random_controller(shapes, i));
      EXPECT_FALSE(findings.has_errors()) << to_string(findings);
    }
  }

  std::uint64_t random_below(std::uint64_t limit) {
    const Lock lock(mutex_);
    return random_() % limit;
  }

  /// Until so many more calls have begun, or the answer is there. A robot at rest is looked at now and then,
  /// which are calls, too.
  void wait_for_calls(std::uint64_t count, const std::future<SwitchResult>& answer) {
    Lock lock(mutex_);
    const std::uint64_t last = calls_ + count;
    EXPECT_TRUE(called_.wait_for(mutex_, segue::testing::kPatience, [&] {
      return calls_ >= last || answer.wait_for(0s) == std::future_status::ready;
    }));
  }
  /// From now on, or no more, processes die in the middle of calls.
  void set_mortal(bool mortal) {
    const Lock lock(mutex_);
    mortal_ = mortal;
  }

  deploy::testing::FakeWorld world;
  model::ComponentCatalog catalog;
  std::atomic<int> deaths{0};

 private:
  /// Whether a process dies in the middle of this one.
  bool note_call() {
    const Lock lock(mutex_);
    ++calls_;
    called_.notify_all();
    if (!mortal_ || calls_ < next_death_) {
      return false;
    }
    next_death_ = calls_ + 1 + random_() % kCallsBetweenDeaths;
    return true;
  }
  void kill_some_process() {
    const auto process = world.find("p" + std::to_string(1 + random_below(3)));
    if (process != nullptr) {
      ++deaths;
      world.kill(process);
    }
  }

  static process_server::Launch launch() {
    process_server::Launch launch;
    launch.robot = "robot";
    launch.stand_in = true;
    return launch;
  }

  static RuntimeOptions impatient() {
    RuntimeOptions options;
    options.policies.restart.backoff = 1ms;
    options.policies.watch = 20ms;
    return options;
  }

  Mutex mutex_;  ///< protects everything below up to the host
  Random random_;
  ConditionVariable called_;
  std::uint64_t calls_ = 0;
  bool mortal_ = false;
  std::uint64_t next_death_ = 0;  ///< at this call
  task_host::LibrarySet libraries_;
  task_host::LocalTaskHost local_{
      libraries_, catalog, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}}};
  deploy::testing::FakeProcesses processes_{world};
  deploy::testing::FakeService own_{world, world.own()};
  fleet::DeployedTaskHost host_{own_,     processes_, deploy::testing::connector(world),
                                launch(), local_,     {60s, 1h}};

 public:
  Runtime runtime{"robot", host_, catalog, impatient()};
};

std::string story(const SwitchResult& result) {
  std::string text = result.from.str() + " -> " + result.to.str() + ": " +
                     std::string(to_string(result.outcome)) +
                     (result.error ? ", " + to_string(*result.error) : std::string());
  for (const auto& action : result.actions) {
    text += "\n  " + std::string(to_string(action.action.phase)) + ' ' + action.action.label();
    if (action.error) {
      text += ": " + to_string(*action.error);
    }
  }
  return text;
}

class Overtaking : public ::testing::Test {
 protected:
  /// Sends requests, some of which it does not wait for, and checks how they end. A pause is as long as so
  /// many calls.
  void be_a_client(std::uint64_t longest_pause) {
    std::vector<std::pair<int, std::future<SwitchResult>>> sent;
    for (int i = 0; i < kRequestsARound; ++i) {
      const int deaths_before = robot_.deaths;
      auto answer = robot_.runtime.request(controller_name(robot_.random_below(kControllers)));
      if (robot_.random_below(2) == 0) {
        check(deaths_before, answer.get());
      } else {
        robot_.wait_for_calls(robot_.random_below(longest_pause), answer);
        sent.emplace_back(deaths_before, std::move(answer));
      }
    }
    for (auto& [deaths_before, answer] : sent) {
      check(deaths_before, answer.get());
    }
  }

  void check(int deaths_before, const SwitchResult& result) {
    done_ += result.outcome == Outcome::Done ? 1 : 0;
    superseded_ += result.outcome == Outcome::Superseded ? 1 : 0;
    failed_ += result.outcome == Outcome::Failed ? 1 : 0;
    const bool as_asked = result.outcome == Outcome::Done || result.outcome == Outcome::Superseded;
    const bool disturbed = result.outcome == Outcome::Failed && robot_.deaths > deaths_before;
    EXPECT_TRUE(as_asked || disturbed) << story(result);
  }

  /// One more request gets the robot where it wants, and the leftovers are collected. Where processes died,
  /// what that broke may be noticed only after the request, so another one may be needed.
  void expect_in_order() {
    const auto name = controller_name(robot_.random_below(kControllers));
    const model::Network wanted = *robot_.runtime.controller(name);
    SwitchResult result;
    for (int left = robot_.deaths > 0 ? 4 : 1; left > 0; --left) {
      result = robot_.runtime.switch_to(name);
      if (result.outcome == Outcome::Done && comes_about(wanted, left > 1)) {
        return;
      }
    }
    FAIL() << story(result)
           << "\ntruly: " << ::testing::PrintToString(model::differences(wanted, robot_.world.truth()))
           << "\nseen: " << ::testing::PrintToString(robot_.runtime.observed_differences())
           << "\norphaned endpoints: " << robot_.world.orphaned_endpoints();
  }

  /// `may_break`: false too where the runtime sees that it does not, so that it has to be asked once more.
  bool comes_about(const model::Network& wanted, bool may_break) {
    bool done = false;
    EXPECT_TRUE(segue::testing::eventually([&] {
      done = equivalent(wanted, robot_.world.truth());
      return done || (may_break && !robot_.runtime.observed_differences().empty());
    }));
    return done;
  }

  void run(bool with_deaths) {
    const std::uint64_t requests = setting("SEGUE_REQUESTS", kRequests);
    std::uint64_t sent = 0;
    while (sent < requests && !HasFailure()) {
      const std::uint64_t many = 1 + robot_.random_below(kMostClients);
      const std::uint64_t longest_pause = 1 + robot_.random_below(100);
      sent += many * kRequestsARound;
      std::vector<std::thread> clients;
      robot_.set_mortal(with_deaths);
      for (std::uint64_t i = 0; i < many; ++i) {
        clients.emplace_back([&] { be_a_client(longest_pause); });
      }
      for (auto& client : clients) {
        client.join();
      }
      robot_.set_mortal(false);
      expect_in_order();
    }
    RecordProperty("done", done_.load());
    RecordProperty("superseded", superseded_.load());
    RecordProperty("failed", failed_.load());
    RecordProperty("deaths", robot_.deaths);
  }

  Robot robot_{setting("SEGUE_SEED", 20261122)};
  std::atomic<int> done_ = 0;
  std::atomic<int> superseded_ = 0;
  std::atomic<int> failed_ = 0;
};

TEST_F(Overtaking, RequestsEndDoneOrSuperseded) {
  run(false);
}

TEST_F(Overtaking, ProcessesMayDieMeanwhile) {
  run(true);
}

}  // namespace
}  // namespace segue::runtime
