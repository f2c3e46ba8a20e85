// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/instance_allocator.hpp>
#include <segue/task_host/local_task_host.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <string>

namespace segue::runtime::detail {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

model::Pool range(const std::string& name, int least, int most, const std::string& host = "") {
  model::Pool pool;
  pool.name = name;
  pool.least = least;
  pool.most = most;
  pool.idle_after = 10s;
  if (!host.empty()) pool.process.host = model::HostName(host);
  return pool;
}

/// Of pools on a host that has no tasks, with a clock that the test moves.
class Allocation : public ::testing::Test {
 protected:
  void have(std::vector<model::Pool> pools) {
    pools_ = std::move(pools);
    allocator_.emplace(pools_, budget_, calls_);
  }
  /// Supervision has seen that these run, and no other one.
  void see(const std::map<std::string, int>& pids) {
    auto seen = allocator_->pools();
    for (PoolReport& pool : seen) {
      for (PoolInstance& one : pool.instances) {
        const auto found = pids.find(one.task.str());
        one.ready = found != pids.end();
        one.pid = one.ready ? found->second : 0;
        one.reason = one.ready ? "" : "does not run";
        calls_.starts(one.task);
      }
    }
    allocator_->note(seen, now_);
  }
  std::string take(const std::string& pool = "planner", const model::TakenInstance& lost = {}) {
    const auto taken = allocator_->take({pool, lost}, since_, now_);
    return !taken ? "waits" : *taken ? (*taken)->task : to_string(taken->error());
  }
  /// The instance that is made for those who wait; it runs then.
  std::string make() {
    const auto made = allocator_->next_to_make(now_, [this](const model::DeploymentKey& process) {
      const auto found = memory_.find(process.process.str());
      return found == memory_.end() ? 0 : found->second;
    });
    if (!made) return "none";
    allocator_->add(*made, now_);
    return made->str();
  }
  std::string leaves() {
    const auto left = allocator_->next_to_leave(now_);
    return left ? left->str() : "none";
  }
  PoolReport report(std::size_t pool = 0) { return allocator_->pools().at(pool); }

  model::ComponentCatalog catalog_;
  task_host::LibrarySet libraries_;
  task_host::LocalTaskHost host_{
      libraries_, catalog_, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}}};
  model::Network no_pools_;
  InstanceCalls calls_{host_, no_pools_, [] {}};
  model::PoolBudget budget_;
  std::vector<model::Pool> pools_;
  std::optional<InstanceAllocator> allocator_;
  std::map<std::string, std::uint64_t> memory_;
  TimePoint since_{1000s};
  TimePoint now_{1000s};
};

TEST_F(Allocation, GivesEachInstanceToOneCallerAtATime) {
  have({range("planner", 2, 2)});
  see({{"planner_1", 11}, {"planner_2", 12}});
  EXPECT_EQ(take(), "planner_1");
  EXPECT_EQ(take(), "planner_2");
  EXPECT_EQ(take(), "waits");
  allocator_->used(model::TaskId("planner_1"), now_);
  EXPECT_EQ(take(), "planner_1") << "its call has ended";
}

TEST_F(Allocation, GivesNoInstanceThatCarriesOutACall) {
  have({range("planner", 1, 1)});
  see({{"planner_1", 11}});
  const auto call = calls_.begin({model::TaskId("planner_1"), 11});
  EXPECT_EQ(take(), "waits");
  calls_.ended(call, InstanceCalls::End::Answered);
  EXPECT_EQ(take(), "planner_1");
}

TEST_F(Allocation, GivesAnInstanceToOthersWhereItsCallerDoesNotCallIt) {
  have({range("planner", 1, 1)});
  see({{"planner_1", 11}});
  EXPECT_EQ(take(), "planner_1");
  now_ += InstanceAllocator::kReserved - 1ns;
  EXPECT_EQ(take(), "waits");
  now_ += 1ns;
  EXPECT_EQ(take(), "planner_1");
}

TEST_F(Allocation, GivesRatherAnotherInstanceThanOneThatWasLost) {
  have({range("planner", 2, 2)});
  see({{"planner_1", 11}, {"planner_2", 12}});
  EXPECT_EQ(take("planner", {"planner_1", 7}), "planner_2") << "it runs again";
  EXPECT_EQ(take("planner", {"planner_1", 7}), "planner_1") << "rather than none";
}

TEST_F(Allocation, GivesNoInstanceThatItsCallerHasLostBeforeItIsSeenAgain) {
  have({range("planner", 1, 1)});
  see({{"planner_1", 11}});
  now_ += 1s;
  since_ = now_;
  EXPECT_EQ(take("planner", {"planner_1", 11}), "waits");
  see({{"planner_1", 11}});
  EXPECT_EQ(take(), "waits") << "supervision has looked before it was lost";
  now_ += 1ns;
  see({{"planner_1", 11}});
  EXPECT_EQ(take("planner", {"planner_1", 11}), "planner_1") << "its task runs anew in the same process";
}

TEST_F(Allocation, GivesNoInstanceThatWasLost) {
  have({range("planner", 1, 1)});
  see({{"planner_1", 11}});
  allocator_->lost(model::TaskId("planner_1"), "its process is gone", now_);
  EXPECT_EQ(take(), "waits");
  see({{"planner_1", 21}});
  EXPECT_EQ(take(), "planner_1");
}

TEST_F(Allocation, SaysOfALostInstanceWhatSupervisionKnows) {
  have({range("planner", 1, 1)});
  auto seen = allocator_->pools();
  seen[0].instances[0].given_up = true;
  seen[0].instances[0].reason = "its process is gone: signal 9";
  allocator_->note(seen, now_);
  allocator_->lost(model::TaskId("planner_1"), "is fatal", now_);
  EXPECT_THAT(take(), HasSubstr("planner_1: its process is gone: signal 9"));
}

TEST_F(Allocation, AnswersThoseWhoWaitLongWhileNoInstanceIsReady) {
  have({range("planner", 0, 1)});
  EXPECT_EQ(take(), "waits");
  now_ += InstanceAllocator::kReadyDeadline;
  EXPECT_EQ(take(), "waits");
  now_ += 1ns;
  EXPECT_THAT(take(), HasSubstr("no instance of pool 'planner' is ready"));
  since_ = now_;
  EXPECT_EQ(take(), "waits") << "that one waits for a short time";
}

TEST_F(Allocation, LetsCallersWaitAsLongAsAnyInstanceIsReady) {
  have({range("planner", 1, 1)});
  see({{"planner_1", 11}});
  const auto call = calls_.begin({model::TaskId("planner_1"), 11});
  now_ += 1h;
  EXPECT_EQ(take(), "waits") << "until it has answered";
  calls_.ended(call, InstanceCalls::End::Unknown);
  allocator_->lost(model::TaskId("planner_1"), "its process is gone", now_);
  now_ += InstanceAllocator::kReadyDeadline;
  EXPECT_EQ(take(), "waits");
  now_ += 1ns;
  EXPECT_THAT(take(), HasSubstr("is ready: planner_1: its process is gone"));
}

TEST_F(Allocation, AnswersAtOnceWhereNoInstanceWillCome) {
  have({range("planner", 1, 2)});
  auto seen = allocator_->pools();
  seen[0].instances[0].given_up = true;
  allocator_->note(seen, now_);
  EXPECT_EQ(take(), "waits") << "another one may be made";
  allocator_->add(model::TaskId("planner_2"), now_);
  EXPECT_EQ(take(), "waits");
  seen = allocator_->pools();
  for (PoolInstance& one : seen[0].instances)
    one.given_up = true;
  allocator_->note(seen, now_);
  EXPECT_THAT(take(), HasSubstr("no instance of pool 'planner' is ready: planner_1: "));
  EXPECT_THAT(take("plannr"), HasSubstr("the robot has no pool 'plannr'"));
}

TEST_F(Allocation, MakesAsManyInstancesAsCallersWaitFor) {
  have({range("planner", 1, 3)});
  see({{"planner_1", 11}});
  EXPECT_EQ(make(), "none") << "nobody waits";
  EXPECT_EQ(take(), "planner_1");
  EXPECT_TRUE(allocator_->begin_waiting("planner"));
  EXPECT_EQ(make(), "planner_2");
  EXPECT_EQ(make(), "none") << "that one will be free";
  allocator_->begin_waiting("planner");
  EXPECT_EQ(make(), "planner_3");
  allocator_->begin_waiting("planner");
  EXPECT_FALSE(allocator_->begin_waiting("planner")) << "it can have no more";
  EXPECT_EQ(make(), "none");
  EXPECT_EQ(report().waiting, 4);
}

TEST_F(Allocation, MakesNoneForACallerWhoWaitsNoLonger) {
  have({range("planner", 0, 2)});
  allocator_->begin_waiting("planner");
  allocator_->end_waiting("planner");
  EXPECT_EQ(make(), "none");
  allocator_->begin_waiting("planner");
  EXPECT_EQ(make(), "planner_1") << "one that has none is made on the first demand";
}

TEST_F(Allocation, MakesAnotherInstanceInPlaceOfOneThatIsGivenUp) {
  have({range("planner", 1, 2)});
  allocator_->begin_waiting("planner");
  EXPECT_EQ(make(), "none") << "it is being started";
  auto seen = allocator_->pools();
  seen[0].instances[0].given_up = true;
  allocator_->note(seen, now_);
  EXPECT_EQ(make(), "planner_2");
}

TEST_F(Allocation, EndsInstancesThatNobodyHasNeededForAWhile) {
  have({range("planner", 1, 3)});
  allocator_->add(model::TaskId("planner_2"), now_);
  allocator_->add(model::TaskId("planner_3"), now_);
  see({{"planner_1", 11}, {"planner_2", 12}, {"planner_3", 13}});
  now_ += 5s;
  EXPECT_EQ(take("planner", {"planner_1", 7}), "planner_2");
  allocator_->used(model::TaskId("planner_2"), now_);
  now_ += 5s - 1ns;
  EXPECT_EQ(leaves(), "none");
  now_ += 1ns;
  EXPECT_EQ(leaves(), "planner_3") << "rather than one with a lower number";
  EXPECT_EQ(leaves(), "planner_1");
  now_ += 1h;
  EXPECT_EQ(leaves(), "none") << "the least number stays";
  EXPECT_EQ(report().instances.at(0).task.str(), "planner_2");
  EXPECT_EQ(calls_.begin({model::TaskId("planner_3"), 13}), 0U) << "it takes no calls any more";
  allocator_->begin_waiting("planner");
  allocator_->begin_waiting("planner");
  EXPECT_EQ(make(), "planner_1") << "the lowest number that is free";
}

TEST_F(Allocation, EndsNoneThatWorksOrIsTakenOrForWhichSomebodyWaits) {
  have({range("planner", 0, 2)});
  allocator_->add(model::TaskId("planner_1"), now_);
  see({{"planner_1", 11}});
  const auto call = calls_.begin({model::TaskId("planner_1"), 11});
  now_ += 1h;
  EXPECT_EQ(leaves(), "none");
  calls_.ended(call, InstanceCalls::End::Answered);
  EXPECT_EQ(take(), "planner_1");
  EXPECT_EQ(leaves(), "none");
  now_ += 1h;
  allocator_->begin_waiting("planner");
  EXPECT_EQ(leaves(), "none");
  allocator_->end_waiting("planner");
  EXPECT_EQ(leaves(), "planner_1");
}

TEST_F(Allocation, EndsRatherAnInstanceThatDoesNotRun) {
  have({range("planner", 1, 3)});
  allocator_->add(model::TaskId("planner_2"), now_);
  allocator_->add(model::TaskId("planner_3"), now_);
  see({{"planner_1", 11}, {"planner_3", 13}});
  now_ += 1h;
  EXPECT_EQ(leaves(), "planner_2");
}

TEST_F(Allocation, KeepsToTheBudgetOfEachComputer) {
  budget_.processes = 1;
  have({range("planner", 1, 3), range("mapper", 0, 2), range("far", 0, 1, "arm_pc")});
  see({});
  for (const char* pool : {"planner", "planner", "mapper", "far"})
    allocator_->begin_waiting(pool);
  EXPECT_EQ(make(), "planner_2");
  EXPECT_EQ(make(), "far_1") << "the one that there may be here is used";
  EXPECT_EQ(make(), "none");
  EXPECT_THAT(report(1).held_back, HasSubstr("'pool_budget' permits 1 processes beyond"));
  EXPECT_EQ(report(2).held_back, "");
  now_ += InstanceAllocator::kReadyDeadline + 1ns;
  EXPECT_THAT(take("mapper"), HasSubstr("is ready: 'pool_budget' permits"));
  allocator_->end_waiting("mapper");
  EXPECT_EQ(report(1).held_back, "") << "nobody waits for it";
}

TEST_F(Allocation, KeepsToTheMemoryOfTheBudget) {
  budget_.memory = 250'000'000;
  have({range("planner", 1, 4)});
  see({{"planner_1", 11}});
  memory_ = {{"planner_1", 100'000'000}, {"planner_2", 90'000'000}};
  calls_.begin({model::TaskId("planner_1"), 11});
  for (int i = 0; i < 4; ++i)
    allocator_->begin_waiting("planner");
  EXPECT_EQ(make(), "planner_2");
  EXPECT_EQ(make(), "planner_3") << "90 MB are used, and 100 MB more fit";
  memory_["planner_3"] = 100'000'000;
  EXPECT_EQ(make(), "none");
  EXPECT_THAT(report().held_back, HasSubstr("permits 250 MB, of which 190 MB are used"));
  memory_["planner_3"] = 60'000'000;
  EXPECT_EQ(make(), "planner_4");
}

TEST_F(Allocation, BeginsAnewWithTheLeastNumbers) {
  have({range("planner", 1, 3)});
  allocator_->add(model::TaskId("planner_3"), now_);
  EXPECT_TRUE(allocator_->is_wanted(model::TaskId("planner_3")));
  allocator_->reset();
  EXPECT_FALSE(allocator_->is_wanted(model::TaskId("planner_3")));
  EXPECT_TRUE(allocator_->is_wanted(model::TaskId("planner_1")));
  EXPECT_EQ(report().instances.size(), 1U);
}

}  // namespace
}  // namespace segue::runtime::detail
