// SPDX-License-Identifier: Apache-2.0
#include <segue/task_host/split_batch.hpp>
#include <segue/task_host/task_access.hpp>
#include <segue/task_host/task_forwarder.hpp>
#include <segue/task_host/test_support.hpp>

#include <gmock/gmock.h>

#include <map>
#include <string>

namespace segue::task_host {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using testing::on_task;
using testing::soon;

/// No task can be found here.
class NoPlace final : public TaskForwarder<TaskAccess> {
 public:
  explicit NoPlace(Error why) : why_(std::move(why)) {}
  void begin_all(std::vector<model::Action> actions, TimePoint /*deadline*/, Completion completed) override {
    completed(all_failed(actions.size(), why_));
  }

  mutable std::vector<Purpose> purposes{};

 protected:
  [[nodiscard]] Result<TaskPlace> find_place(const model::TaskId& /*task*/, Purpose purpose) const override {
    purposes.push_back(purpose);
    return why_;
  }

 private:
  const Error why_;
};

template <class T>
std::string subject_of(const Result<T>& answer) {
  return answer ? "none" : answer.error().subject;
}

/// The subjects of the errors of all verbs on a task "a".
std::vector<std::string> subjects(TaskAccess& tasks) {
  const model::TaskId a("a");
  std::string watched;
  tasks.watch({a, {}, false}, Wait(soon()),
              [&](const Result<TaskLevel>& level) { watched = subject_of(level); });
  return {subject_of(tasks.save_state(a, soon())),
          subject_of(tasks.restore_state(a, {}, soon())),
          subject_of(tasks.describe(a)),
          subject_of(tasks.properties(a)),
          subject_of(tasks.details(a)),
          watched,
          subject_of(tasks.set_property(a, "gain", 1, soon())),
          subject_of(tasks.call(a, "reset", {}, soon())),
          subject_of(tasks.open_reader({a, "out"}, 1)),
          subject_of(tasks.write({a, "in"}, 1, soon()))};
}

TEST(TaskForwarder, SaysWhichTaskHasNoPlaceWhateverIsAskedOfIt) {
  NoPlace nowhere(fail(ErrorCode::Unavailable, "gone"));
  EXPECT_THAT(subjects(nowhere), Each("a"));
}

TEST(TaskForwarder, LeavesWhatAnErrorSaysItIsAbout) {
  NoPlace nowhere(fail(ErrorCode::Superseded, "another runtime has it", "spot"));
  EXPECT_THAT(subjects(nowhere), Each("spot"));
}

TEST(TaskForwarder, AsksForTheNextIncarnationOnlyToRestoreItsState) {
  NoPlace nowhere(fail(ErrorCode::Unavailable, "gone"));
  (void)nowhere.save_state(model::TaskId("a"), soon());
  (void)nowhere.restore_state(model::TaskId("a"), {}, soon());
  (void)nowhere.properties(model::TaskId("a"));
  EXPECT_THAT(nowhere.purposes, ElementsAre(Purpose::Change, Purpose::Restore, Purpose::Observe));
}

/// The outcomes of three actions, once all are known.
struct Outcomes {
  Completion listener() {
    return [this](std::vector<Completed> ended) {
      for (auto& one : ended)
        by_index.emplace(one.index, std::move(one.outcome));
    };
  }
  std::map<std::size_t, Result<void>> by_index{};
};

std::vector<model::Action> three_stops() {
  using enum model::ActionKind;
  return {on_task(Stop, "a"), on_task(Stop, "b"), on_task(Stop, "c")};
}

TEST(SplitBatch, ReportsTheEndsOfAPartUnderTheirPlacesInTheWhole) {
  Outcomes outcomes;
  const auto batch = std::make_shared<SplitBatch>(three_stops(), outcomes.listener());
  std::vector<std::string> noted;
  const auto part = batch->part({0, 2}, [&](const model::Action& action, const Result<void>& outcome) {
    noted.push_back(action.label() + (outcome ? " done" : " failed"));
  });
  part({{1, fail(ErrorCode::HookFailed, "bad")}, {0, {}}});
  batch->fail({1}, fail(ErrorCode::Unavailable, "gone"));
  EXPECT_THAT(noted, ElementsAre("stop c failed", "stop a done"));
  EXPECT_TRUE(outcomes.by_index.at(0));
  EXPECT_EQ(outcomes.by_index.at(1).error().subject, "stop b");
  EXPECT_EQ(outcomes.by_index.at(2).error().code, ErrorCode::HookFailed);
}

TEST(SplitBatch, CarriesOutAnActionOnTheCallersThreadWhereThereIsNoOther) {
  Outcomes outcomes;
  concurrent::ThreadPool closed("test", {1, 1});
  closed.close();
  const auto batch = std::make_shared<SplitBatch>(three_stops(), outcomes.listener());
  batch->run(closed, 1, [] { return Result<void>(); });
  batch->fail({0, 2}, fail(ErrorCode::Unavailable, "gone"));
  EXPECT_TRUE(outcomes.by_index.at(1));
}

}  // namespace
}  // namespace segue::task_host
