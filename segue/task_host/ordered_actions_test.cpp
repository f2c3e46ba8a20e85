// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>
#include <segue/task_host/early_end.hpp>
#include <segue/task_host/ordered_actions.hpp>

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include <atomic>
#include <map>
#include <set>

namespace segue::task_host {
namespace {

using namespace std::chrono_literals;
using model::Action;
using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;

using Ids = std::vector<int>;

Action action(int id, const Ids& after = {}) {
  return {id, model::ActionKind::Start, model::TaskAction{model::TaskId("t" + std::to_string(id))},
          model::Phase::Prepare, after};
}

/// Carries out actions as a test says, and notes what it was asked.
class Performers {
 public:
  /// The answers to actions; nothing: the action is never reported.
  std::map<int, std::optional<Result<void>>> answers;
  std::map<int, const void*> places;
  std::vector<Ids> batches;
  int told = 0;
  model::Network observed;
  std::function<void(int id)> on_begin = [](int) {};

  OrderedActions::Performer performer(bool with_places) {
    OrderedActions::Performer performer;
    performer.begin = [this](std::vector<Action> actions, TimePoint, Completion completed) {
      Ids& ids = batches.emplace_back();
      for (const auto& one : actions)
        ids.push_back(one.id);
      begin(actions, completed);
    };
    performer.observe = [this] { return observed; };
    if (with_places) {
      performer.place = [this](const Action& one) {
        const auto found = places.find(one.id);
        return found == places.end() ? nullptr : found->second;
      };
    }
    performer.begin_no_more = [this] { ++told; };
    return performer;
  }

 private:
  /// Carries out actions as a host does: in their order, until one fails.
  void begin(const std::vector<Action>& actions, const Completion& completed) {
    std::set<int> failed;
    for (std::size_t i = 0; i < actions.size(); ++i) {
      const int id = actions[i].id;
      Completed one{i, Result<void>()};
      const bool waits = std::any_of(actions[i].after.begin(), actions[i].after.end(),
                                     [&](int before) { return failed.contains(before); });
      if (waits) {
        one.begun = false;
        one.outcome = fail(ErrorCode::Cancelled, "was not begun");
      } else {
        on_begin(id);
        const auto answer = answers.find(id);
        if (answer != answers.end() && !answer->second) continue;
        if (answer != answers.end()) one.outcome = *answer->second;
      }
      if (!one.outcome) failed.insert(id);
      completed({std::move(one)});
    }
  }
};

struct Ends {
  std::map<int, Completed> reports;
  [[nodiscard]] Ids ids(bool begun, bool done) const {
    Ids some;
    for (const auto& [id, one] : reports) {
      if (one.begun == begun && one.outcome.has_value() == done) some.push_back(id);
    }
    return some;
  }
};

Ends ends_of(Performers& performers, const std::vector<Action>& actions, bool with_places = false,
             const EarlyEnd& early_end = {}) {
  Ends all;
  std::make_shared<OrderedActions>(actions, 10s, performers.performer(with_places),
                                   [&](std::vector<Completed> ended) {
                                     for (auto& one : ended) {
                                       const int id = actions[one.index].id;
                                       EXPECT_TRUE(all.reports.emplace(id, std::move(one)).second) << id;
                                     }
                                   })
      ->run(early_end);
  EXPECT_EQ(all.reports.size(), actions.size());
  return all;
}

TEST(OrderedActions, WhatIsReadyBeginsTogether) {
  Performers performers;
  const Ends ended =
      ends_of(performers, {action(1), action(2), action(3, {1, 2}), action(4, {3}), action(5, {9})});
  EXPECT_THAT(performers.batches, ElementsAre(Ids{1, 2, 5}, Ids{3}, Ids{4}));
  EXPECT_EQ(ended.ids(true, true).size(), 5U);
  EXPECT_EQ(performers.told, 0);
  EXPECT_TRUE(ends_of(performers, {}).reports.empty());
}

TEST(OrderedActions, AChainAtOnePlaceIsOneBatch) {
  Performers performers;
  const int a = 0;
  const int b = 0;
  performers.places = {{1, &a}, {2, &a}, {3, &b}, {4, &a}, {5, &a}};
  // 4 waits for 3, which is elsewhere; 5 for 4. 6 is at no place.
  const Ends ended = ends_of(performers,
                             {action(1), action(2, {1}), action(3), action(4, {2, 3}), action(5, {4}),
                              action(6, {5}), action(7, {6})},
                             true);
  EXPECT_THAT(performers.batches, ElementsAre(Ids{1, 2, 3}, Ids{4, 5}, Ids{6}, Ids{7}));
  EXPECT_EQ(ended.ids(true, true).size(), 7U);
}

TEST(OrderedActions, AfterAFailureNothingBegins) {
  for (const bool with_places : {false, true}) {
    Performers performers;
    const int here = 0;
    performers.places = {{1, &here}, {2, &here}, {3, &here}, {4, &here}};
    performers.answers[2] = Result<void>(fail(ErrorCode::Internal, "broken"));
    const Ends ended =
        ends_of(performers, {action(1), action(2, {1}), action(3, {2}), action(4, {3})}, with_places);
    EXPECT_THAT(ended.ids(true, true), ElementsAre(1));
    EXPECT_THAT(ended.ids(true, false), ElementsAre(2));
    EXPECT_THAT(ended.ids(false, false), ElementsAre(3, 4));
    EXPECT_EQ(ended.reports.at(2).outcome.error().message, "broken");
  }
}

TEST(OrderedActions, WhatAHostDidNotBeginWithoutAFailureIsOne) {
  Performers performers;
  OrderedActions::Performer performer;
  performer.begin = [](const std::vector<Action>& actions, TimePoint, const Completion& completed) {
    for (std::size_t i = 0; i < actions.size(); ++i) {
      Completed one{i, fail(ErrorCode::Cancelled, "was not begun")};
      one.begun = false;
      completed({std::move(one)});
    }
  };
  Ends ended;
  std::make_shared<OrderedActions>(
      std::vector{action(1)}, 10s, std::move(performer),
      [&](std::vector<Completed> some) { ended.reports.emplace(1, std::move(some.front())); })
      ->run({});
  EXPECT_THAT(ended.ids(true, false), ElementsAre(1)) << "else nobody would know that it is missing";
}

TEST(OrderedActions, WhatWaitsForItselfFails) {
  Performers performers;
  const Ends ended = ends_of(performers, {action(1, {3}), action(2), action(3, {1, 2})});
  EXPECT_THAT(ended.ids(true, true), ElementsAre(2));
  EXPECT_THAT(ended.ids(true, false), ElementsAre(1, 3));
}

TEST(OrderedActions, AfterARequestToStopNothingBegins) {
  for (const int when : {0, 1, 2}) {
    Performers performers;
    std::stop_source stop;
    performers.on_begin = [&](int id) {
      if (id == when) stop.request_stop();
    };
    if (when == 0) stop.request_stop();
    const Ends ended =
        ends_of(performers, {action(1), action(2, {1}), action(3, {2})}, false, {.stop = stop.get_token()});
    EXPECT_EQ(ended.ids(true, true).size(), static_cast<std::size_t>(when));
    EXPECT_EQ(ended.ids(false, false).size(), static_cast<std::size_t>(3 - when));
    EXPECT_EQ(performers.told, when == 0 ? 0 : 1);
  }
}

TEST(OrderedActions, WhatIsLeftInProgressIsNotWaitedFor) {
  Performers performers;
  performers.answers[1] = std::nullopt;
  performers.answers[4] = std::nullopt;
  Leaving leaving;
  performers.on_begin = [&](int id) {
    if (id != 5) return;
    for (const int left : {1, 4})
      leaving.leave([&](const Action& one) { return one.id == left; });
  };
  const Ends ended =
      ends_of(performers, {action(1), action(2, {1}), action(3), action(4), action(5), action(6, {5})}, false,
              {.leaving = &leaving});
  EXPECT_THAT(ended.ids(false, false), ElementsAre(1, 2, 4, 6));
  EXPECT_THAT(ended.ids(true, true), ElementsAre(3, 5)) << "which had begun, and may not be left";
  EXPECT_EQ(performers.told, 1);
}

TEST(OrderedActions, WhatIsLeftInProgressMayEndLate) {
  Completion late;
  Leaving leaving;
  OrderedActions::Performer performer;
  performer.begin = [&](const std::vector<Action>&, TimePoint, Completion completed) {
    late = std::move(completed);
    leaving.leave([](const Action&) { return true; });
  };
  int reported = 0;
  Ids left;
  std::make_shared<OrderedActions>(
      std::vector<Action>{action(1), action(2, {1})}, 10s, std::move(performer),
      [&](const std::vector<Completed>& ended) { reported += static_cast<int>(ended.size()); })
      ->run({.leaving = &leaving, .left_ended = [&](const Action& one) { left.push_back(one.id); }});
  EXPECT_EQ(reported, 2);
  EXPECT_TRUE(left.empty());
  for (int twice = 0; twice < 2; ++twice)
    late({{0, Result<void>()}});
  EXPECT_EQ(reported, 2);
  EXPECT_EQ(left, Ids{1});
  leaving.leave([](const Action&) { return true; });
}

TEST(OrderedActions, WhatWasNotReportedInTimeCountsByWhatIsSeen) {
  for (const TaskState state : {TaskState::Running, TaskState::Stopped}) {
    Performers performers;
    performers.answers[1] = Result<void>(fail(ErrorCode::DeadlineExceeded, "late"));
    auto& task = performers.observed.tasks.emplace_back();
    task.id = model::TaskId("t1");
    task.state = state;
    const Ends ended = ends_of(performers, {action(1), action(2, {1})});
    EXPECT_EQ(ended.ids(true, true).size(), state == TaskState::Running ? 2U : 0U);
  }
}

TEST(OrderedActions, AHostThatThrowsOrRepeatsItselfDoesNoHarm) {
  OrderedActions::Performer performer;
  performer.begin = [](const std::vector<Action>& actions, TimePoint, const Completion& completed) {
    completed({{0, Result<void>()}, {0, Result<void>()}, {7, Result<void>()}});
    if (actions.front().id == 2) throw std::runtime_error("no");
    completed({{0, Result<void>()}});
  };
  std::vector<std::string> said;
  std::make_shared<OrderedActions>(std::vector{action(1), action(2, {1}), action(3, {1})}, 10s,
                                   std::move(performer),
                                   [&](std::vector<Completed> ended) {
                                     for (const auto& one : ended)
                                       said.push_back(one.outcome ? "done" : one.outcome.error().message);
                                   })
      ->run({});
  EXPECT_THAT(said, UnorderedElementsAre("done", "done", "the host threw: no"));
}

/// Actions in a random order over random places, each of which works on threads of its own.
RC_GTEST_PROP(OrderedActionsProperty, EveryActionComesAfterThoseItWaitsFor, ()) {
  const int count = *rc::gen::inRange(1, 25);
  const auto places =
      *rc::gen::container<std::vector<int>>(static_cast<std::size_t>(count), rc::gen::inRange(0, 4));
  const int failing = *rc::gen::inRange(-20, count);
  std::vector<Action> actions;
  for (int id = 0; id < count; ++id) {
    Ids after;
    if (id > 0) after = *rc::gen::resize(3, rc::gen::container<Ids>(rc::gen::inRange(0, id)));
    actions.push_back(action(id, after));
  }
  Mutex mutex;
  std::set<int> done;
  std::set<int> begun;
  std::atomic<bool> wrong = false;
  std::vector<std::thread> threads;
  OrderedActions::Performer performer;
  std::array<int, 4> place{};
  performer.place = [&](const Action& one) -> const void* {
    const int number = places[static_cast<std::size_t>(one.id)];
    return number == 0 ? nullptr : &place.at(static_cast<std::size_t>(number));
  };
  performer.begin = [&](std::vector<Action> some, TimePoint, Completion completed) {
    const Lock lock(mutex);
    threads.emplace_back([&, some = std::move(some), completed = std::move(completed)] {
      bool failed = false;
      for (std::size_t i = 0; i < some.size(); ++i) {
        Completed one{i, Result<void>()};
        {
          const Lock locked(mutex);
          const auto missing = [&](int before) { return !done.contains(before); };
          if (failed) {
            one.begun = false;
            one.outcome = fail(ErrorCode::Cancelled, "was not begun");
          } else {
            wrong = wrong || std::any_of(some[i].after.begin(), some[i].after.end(), missing);
            begun.insert(some[i].id);
            failed = some[i].id == failing;
            if (failed) one.outcome = fail(ErrorCode::Internal, "broken");
            if (!failed) done.insert(some[i].id);
          }
        }
        completed({std::move(one)});
      }
    });
  };
  std::map<int, Completed> reports;
  std::make_shared<OrderedActions>(actions, 60s, std::move(performer), [&](std::vector<Completed> ended) {
    for (auto& one : ended) {
      const int id = actions[one.index].id;
      if (!reports.emplace(id, std::move(one)).second) wrong = true;
    }
  })->run({});
  for (auto& thread : threads)
    thread.join();
  RC_ASSERT(!wrong);
  RC_ASSERT(reports.size() == actions.size());
  for (const auto& [id, one] : reports) {
    RC_ASSERT(one.begun == begun.contains(id));
    RC_ASSERT(one.outcome.has_value() == done.contains(id));
  }
  RC_ASSERT(begun.contains(failing) || done.size() == actions.size());
}

}  // namespace
}  // namespace segue::task_host
