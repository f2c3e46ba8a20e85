// SPDX-License-Identifier: Apache-2.0
#include <segue/journal/database.hpp>
#include <segue/journal/past.hpp>

#include <gmock/gmock.h>

#include <cmath>

#include "journal_test_support.hpp"

namespace segue::journal {
namespace {

using namespace testing;
using ::testing::HasSubstr;
using type::Value;
using Clock = std::chrono::system_clock;

constexpr std::int64_t kStart = 1'800'000'000;

Clock::time_point at(std::int64_t second) {
  return Clock::time_point(std::chrono::seconds(kStart + second));
}

TransitionEntry switched(std::int64_t ended, std::string from, std::string to, int lasted = 2) {
  TransitionEntry entry = transition(static_cast<std::uint64_t>(ended), 2);
  entry.time = at(ended);
  entry.before = "network of " + from;
  entry.after = "network of " + to;
  entry.runs = to;
  entry.from = std::move(from);
  entry.to = std::move(to);
  entry.lasted = std::chrono::seconds(lasted);
  return entry;
}

class PastTest : public ::testing::Test {
 protected:
  Value ask(std::initializer_list<std::pair<std::string, Value>> question) {
    type::ValueMap map;
    for (const auto& [name, value] : question)
      map.set(name, value);
    auto answer = answer_about_past(path_, Value(std::move(map)));
    EXPECT_TRUE(answer) << to_string(answer.error());
    return answer.value_or(Value());
  }
  ErrorCode refusal(const Value& question) {
    const auto answer = answer_about_past(path_, question);
    return answer ? ErrorCode::Internal : answer.error().code;
  }
  Value moment(double second) {
    return ask({{"ask", "at"}, {"time_s", static_cast<double>(kStart) + second}});
  }
  static std::string notes(const Value& moment) {
    std::string all;
    for (const Value& note : moment.find("notes")->as_list())
      all += note.as_string() + "\n";
    return all;
  }

  Folder folder_;
  const std::filesystem::path path_ = folder_ / "j";
};

TEST_F(PastTest, TheClockIsThatOfTheEntries) {
  const auto now = [] { return std::chrono::duration<double>(Clock::now().time_since_epoch()).count(); };
  const double before = now();
  const double told = ask({{"ask", "clock"}}).find("now_s")->as_double();
  EXPECT_GE(told, before);
  EXPECT_LE(told, now());
}

TEST_F(PastTest, RequestsComeInPagesNewestFirst) {
  {
    Journal journal(path_);
    for (int i = 1; i <= 250; ++i)
      journal.add(switched(i, i % 2 == 0 ? "explore" : "dock", i == 77 ? "Manual" : "go"));
  }
  const Value first = ask({{"ask", "requests"}});
  ASSERT_EQ(first.find("requests")->as_list().size(), 100U);
  EXPECT_EQ(*first.find("more"), Value(true));
  const Value& newest = first.find("requests")->as_list().front();
  EXPECT_EQ(*newest.find("request"), Value(250));
  EXPECT_EQ(newest.find("lasted_s")->as_double(), 2.0);
  EXPECT_EQ(*newest.find("actions"), Value(2));
  std::size_t count = 0;
  for (Value before(std::int64_t{1} << 40), more(true); more == Value(true);) {
    const Value page = ask({{"ask", "requests"}, {"before", before}, {"limit", 60}});
    const auto& list = page.find("requests")->as_list();
    count += list.size();
    before = *list.back().find("id");
    more = *page.find("more");
  }
  EXPECT_EQ(count, 250U);
  const Value found = ask({{"ask", "requests"}, {"words", " manual  DOCK "}});
  ASSERT_EQ(found.find("requests")->as_list().size(), 1U);
  EXPECT_EQ(*found.find("requests")->as_list()[0].find("request"), Value(77));
  EXPECT_TRUE(ask({{"ask", "requests"}, {"words", "%"}}).find("requests")->as_list().empty()) << "no pattern";
}

TEST_F(PastTest, ARequestHasItsActionsAndNetworks) {
  TransitionEntry entry = switched(10, "explore", "go");
  entry.actions[0].ended = std::chrono::milliseconds(15);
  entry.undo_actions.push_back(action(9, std::chrono::milliseconds(3)));
  {
    Journal journal(path_);
    journal.add(entry);
    journal.add(switched(20, "go", "explore"));
  }
  const Value past = ask({{"ask", "request"}, {"id", 1}});
  EXPECT_EQ(*past.find("before"), Value("network of explore"));
  EXPECT_EQ(*past.find("after"), Value("network of go"));
  EXPECT_EQ(past.find("lasted_s")->as_double(), 2.0);
  EXPECT_EQ(past.find("actions")->as_list().size(), 2U);
  EXPECT_EQ(past.find("actions")->as_list()[0].find("ended_s")->as_double(), 0.015);
  ASSERT_EQ(past.find("undo_actions")->as_list().size(), 1U);
  EXPECT_EQ(*past.find("undo_actions")->as_list()[0].find("id"), Value(9));
  EXPECT_EQ(refusal(Value::map({{"ask", "request"}, {"id", 3}})), ErrorCode::NotFound);
}

TEST_F(PastTest, ATimeHasWhatRanThenAndWhatIsNotKnown) {
  {
    Journal journal(path_);
    journal.add(RunningEntry{at(0), RunningEntry::Kind::Began, "", "network of nothing"});
    journal.add(switched(10, "", "explore"));
    journal.add(MissionEntry{at(12), MissionEntry::Kind::Began, "ann", "patrol"});
    journal.add(MissionEntry{at(13), MissionEntry::Kind::Began, "ann", "patrol", "look"});
    journal.add(DifferenceEntry{at(14), "slam", "task 'slam' is in exception", "reported"});
    journal.add(MissionEntry{at(16), MissionEntry::Kind::Ended, "ann", "patrol", "look", 0, "", "done"});
    journal.add(MissionEntry{at(17), MissionEntry::Kind::Ended, "ann", "patrol", "", 0, "", "done"});
    journal.add(switched(30, "explore", "go", 5));
    journal.add(RunningEntry{at(40), RunningEntry::Kind::Ended});
    journal.add(RunningEntry{at(60), RunningEntry::Kind::Began, "go", "network of go"});
    journal.add(GapEntry{at(70), 3, "the disk was full"});
    journal.add(switched(80, "go", "dock"));
    journal.add(RunningEntry{at(100), RunningEntry::Kind::Began, "", "network of nothing"});
  }
  const Value none = moment(-5);
  EXPECT_EQ(*none.find("known"), Value(false));
  EXPECT_THAT(notes(none), HasSubstr("nothing was recorded before"));
  EXPECT_EQ(*moment(1).find("network"), Value("network of nothing"));
  const Value busy = moment(15);
  EXPECT_EQ(*busy.find("controller"), Value("explore"));
  EXPECT_EQ(*busy.find("network"), Value("network of explore"));
  EXPECT_EQ(notes(busy), "");
  ASSERT_EQ(busy.find("missions")->as_list().size(), 1U);
  EXPECT_EQ(*busy.find("missions")->as_list()[0].find("actions"), Value::list({"look"}));
  EXPECT_EQ(*busy.find("differences"), Value::list({"task 'slam' is in exception: reported"}));
  EXPECT_TRUE(moment(18).find("missions")->as_list().empty());
  const Value between = moment(27);
  EXPECT_EQ(*between.find("transition"), Value(2));
  EXPECT_EQ(*between.find("network"), Value("network of explore"));
  EXPECT_EQ(*moment(31).find("transition"), Value());
  EXPECT_EQ(*moment(31).find("controller"), Value("go"));
  const Value stopped = moment(50);
  EXPECT_EQ(*stopped.find("known"), Value(false));
  EXPECT_EQ(*stopped.find("network"), Value());
  EXPECT_THAT(notes(stopped), HasSubstr("the runtime had ended"));
  EXPECT_THAT(notes(moment(65)), HasSubstr("3 entries around that time were lost: the disk was full"));
  EXPECT_THAT(notes(moment(90)), HasSubstr("ended without a record of it"));
  EXPECT_EQ(notes(moment(110)), "");
}

TEST_F(PastTest, TheSpanHasFewMarksOfManyRequests) {
  { Journal journal(path_); }
  EXPECT_EQ(*ask({{"ask", "span"}}).find("first_s"), Value());
  {
    Journal journal(path_);
    for (int i = 1; i <= 1700; ++i)
      journal.add(switched(i, "explore", "go"));
  }
  const Value span = ask({{"ask", "span"}});
  EXPECT_EQ(span.find("last_s")->as_double(), static_cast<double>(kStart + 1700));
  EXPECT_EQ(span.find("first_s")->as_double(), static_cast<double>(kStart - 1)) << "when it began";
  EXPECT_GT(span.find("marks")->as_list().size(), 300U);
  EXPECT_LE(span.find("marks")->as_list().size(), 500U);
}

TEST_F(PastTest, NetworksAreKeptOnceAndGoWithTheirTransitions) {
  {
    Journal journal(path_, {.keep_actions = 30, .queue = 20'000});
    for (int i = 1; i <= 100; ++i)
      journal.add(switched(i, "explore", i == 1 ? "once" : "go"));
  }
  auto database = detail::Database::open(path_, detail::Database::Mode::Read);
  ASSERT_TRUE(database);
  EXPECT_EQ(*database->integer("SELECT count(*) FROM network"), 2);
  EXPECT_EQ(*database->integer("SELECT count(*) FROM network WHERE text = 'network of once'"), 0);
}

TEST_F(PastTest, RunsOfMissionsComeInPagesNewestFirst) {
  using Kind = MissionEntry::Kind;
  {
    Journal journal(path_);
    for (int i = 0; i < 5; ++i) {
      MissionEntry began{at(10 * i), Kind::Began, "ann", "patrol"};
      began.mode = "concurrent";
      journal.add(began);
      journal.add(MissionEntry{at(10 * i + 1), Kind::Began, "ann", "patrol", "look"});
      if (i != 2) journal.add(MissionEntry{at(10 * i + 4), Kind::Ended, "ann", "patrol", "", 0, "", "done"});
    }
    journal.add(MissionEntry{at(90), Kind::Began, "ann", "fetch"});
  }
  const Value first = ask({{"ask", "missions"}, {"limit", 4}});
  const auto& runs = first.find("missions")->as_list();
  ASSERT_EQ(runs.size(), 4U);
  EXPECT_EQ(*first.find("more"), Value(true));
  EXPECT_EQ(*runs[0].find("mission"), Value("fetch"));
  EXPECT_EQ(*runs[0].find("ended_s"), Value()) << "it runs";
  EXPECT_EQ(*runs[0].find("mode"), Value(""));
  EXPECT_EQ(*runs[1].find("outcome"), Value("done"));
  EXPECT_EQ(*runs[1].find("mode"), Value("concurrent"));
  EXPECT_EQ(runs[1].find("began_s")->as_double(), static_cast<double>(kStart) + 40);
  EXPECT_EQ(runs[1].find("ended_s")->as_double(), static_cast<double>(kStart) + 44);
  EXPECT_EQ(*runs[3].find("ended_s"), Value()) << "its end was not recorded";
  const Value second = ask({{"ask", "missions"}, {"before", *runs[3].find("id")}});
  EXPECT_EQ(second.find("missions")->as_list().size(), 2U);
  EXPECT_EQ(*second.find("more"), Value(false));
}

TEST_F(PastTest, ARunOfAMissionHasWhatItDid) {
  using Kind = MissionEntry::Kind;
  {
    Journal journal(path_);
    journal.add(MissionEntry{at(1), Kind::Began, "ann", "patrol"});
    journal.add(MissionEntry{at(2), Kind::Began, "ann", "patrol", "look", 3});
    journal.add(MissionEntry{at(3), Kind::Asked, "ann", "patrol", "look", 3, "explore"});
    journal.add(MissionEntry{at(4), Kind::Ended, "ann", "patrol", "look", 3, "", "aborted", "it was dark"});
    journal.add(MissionEntry{at(5), Kind::Ended, "ann", "patrol", "", 0, "", "aborted", "look aborted"});
    journal.add(MissionEntry{at(6), Kind::Began, "ann", "lost"});
    journal.add(MissionEntry{at(7), Kind::Began, "ann", "lost", "look"});
    journal.add(MissionEntry{at(8), Kind::Began, "ann", "again"});
  }
  const Value run = ask({{"ask", "mission"}, {"id", 1}});
  EXPECT_EQ(*run.find("outcome"), Value("aborted"));
  EXPECT_EQ(*run.find("error"), Value("look aborted"));
  EXPECT_EQ(*run.find("dropped"), Value(0));
  const auto& entries = run.find("entries")->as_list();
  ASSERT_EQ(entries.size(), 5U);
  EXPECT_EQ(*entries[0].find("action"), Value(""));
  EXPECT_EQ(*entries[1].find("iteration"), Value(3));
  EXPECT_EQ(*entries[2].find("controller"), Value("explore"));
  EXPECT_EQ(*entries[3].find("error"), Value("it was dark"));
  EXPECT_EQ(entries[3].find("time_s")->as_double(), static_cast<double>(kStart) + 4);
  const Value lost = ask({{"ask", "mission"}, {"id", 6}});
  EXPECT_EQ(*lost.find("ended_s"), Value());
  EXPECT_EQ(lost.find("entries")->as_list().size(), 2U) << "not those of the next run";
  for (const int none : {0, 2, 5, 9})
    EXPECT_EQ(refusal(Value::map({{"ask", "mission"}, {"id", none}})), ErrorCode::NotFound) << none;
}

TEST_F(PastTest, BadQuestionsAreRefused) {
  EXPECT_EQ(refusal(Value::map({{"ask", "span"}})), ErrorCode::NotFound);
  { Journal journal(path_); }
  for (const Value& question :
       {Value(), Value("requests"), Value::map({{"ask", 3}}), Value::map({{"ask", "everything"}}),
        Value::map({{"ask", "requests"}, {"limit", 101}}), Value::map({{"ask", "requests"}, {"limit", 0}}),
        Value::map({{"ask", "requests"}, {"before", -1}}), Value::map({{"ask", "requests"}, {"words", 1}}),
        Value::map({{"ask", "requests"}, {"words", std::string(201, 'x')}}),
        Value::map({{"ask", "requests"}, {"words", "1 2 3 4 5 6 7 8 9"}}),
        Value::map({{"ask", "missions"}, {"limit", 0}}), Value::map({{"ask", "mission"}, {"id", -1}}),
        Value::map({{"ask", "request"}, {"id", "1; DROP TABLE action"}}), Value::map({{"ask", "at"}}),
        Value::map({{"ask", "at"}, {"time_s", -1}}), Value::map({{"ask", "at"}, {"time_s", 1e300}}),
        Value::map({{"ask", "at"}, {"time_s", std::nan("")}})}) {
    EXPECT_EQ(refusal(question), ErrorCode::InvalidArgument);
  }
}

}  // namespace
}  // namespace segue::journal
