// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>
#include <segue/web/page_verbs.hpp>
#include <segue/web/ros2_looks.hpp>
#include <support/eventually.hpp>
#include <support/fake_robot_service.hpp>

#include <gmock/gmock.h>

#include <chrono>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace segue::web {
namespace {

using control::Gate;
using segue::testing::eventually;
using type::Value;

/// A robot with these tasks of ROS 2, by id with their properties (null: it has gone meanwhile), and another.
class RobotOfTasks final : public control::FakeRobotService {
 public:
  using Tasks = std::map<std::string, Value, std::less<>>;
  using FakeRobotService::status;
  using FakeRobotService::task;
  explicit RobotOfTasks(Tasks tasks) : tasks_(std::move(tasks)) {}

  Result<Value> status(const Wait& /*wait*/) override {
    Value::List list{Value::map({{"id", "drive"}, {"component", "demo::Drive"}})};
    for (const auto& [id, properties] : tasks_)
      list.push_back(Value::map({{"id", id}, {"component", "ros2::Node"}}));
    return Value::map({{"robot", "fake"}, {"tasks", Value(std::move(list))}});
  }
  Result<Value> task(std::string_view id, const Wait& /*wait*/) override {
    const auto found = tasks_.find(id);
    EXPECT_NE(found, tasks_.end()) << id << " is not asked for";
    if (found == tasks_.end() || found->second.is_null()) return fail(ErrorCode::NotFound, "no such task");
    return Value::map({{"id", id}, {"properties", found->second}});
  }

 private:
  const Tasks tasks_;
};

Value in_domain(int domain, const char* discovery = "") {
  return Value::map({{"domain", domain}, {"discovery", discovery}, {"name", "/lidar"}, {"timeout", "10s"}});
}

class Ros2LooksTest : public ::testing::Test {
 protected:
  Result<std::unique_ptr<control::RobotService>> connect() {
    const Lock lock(mutex_);
    return Result<std::unique_ptr<control::RobotService>>(std::make_unique<RobotOfTasks>(tasks_));
  }
  void has(RobotOfTasks::Tasks tasks) {
    const Lock lock(mutex_);
    tasks_ = std::move(tasks);
  }
  void sees(Result<Value> answer) {
    const Lock lock(mutex_);
    answer_ = std::move(answer);
  }
  Result<Value> look(const Ros2Place& place) {
    const Lock lock(mutex_);
    places_.push_back(place);
    return answer_;
  }
  /// Those that have been looked at.
  std::vector<Ros2Place> places() {
    const Lock lock(mutex_);
    return places_;
  }
  std::future<Result<Value>> ask(Verbs& verbs, const std::string& arguments = "{}") {
    auto command = Command::parse(R"({"id": 1, "verb": "look_at_ros2", "arguments": )" + arguments + "}");
    const auto answer = std::make_shared<std::promise<Result<Value>>>();
    verbs.begin(std::move(command.value()), Role::Observe, "olga",
                [answer](const Result<Value>& result) { answer->set_value(result); });
    return answer->get_future();
  }
  /// Whether another request is answered.
  static bool status_of(Verbs& verbs) {
    std::promise<bool> answer;
    verbs.begin(Command::parse(R"({"id": 2, "verb": "status"})").value(), Role::Observe, "olga",
                [&answer](const Result<Value>& result) { answer.set_value(result.has_value()); });
    return answer.get_future().get();
  }
  Result<Value> answer_to(const std::string& arguments = "{}") { return ask(verbs_, arguments).get(); }

  Mutex mutex_;
  RobotOfTasks::Tasks tasks_ SEGUE_GUARDED_BY(mutex_);
  std::vector<Ros2Place> places_ SEGUE_GUARDED_BY(mutex_);
  Result<Value> answer_ SEGUE_GUARDED_BY(mutex_) = Value::map({{"nodes", Value(Value::List())}});
  RobotLink link_{[this] { return connect(); }};
  Verbs verbs_{link_, {}, {}, [this](const Ros2Place& place, TimePoint) { return look(place); }};
};

TEST_F(Ros2LooksTest, AreMadeWhereTheEnvironmentSaysForARobotWithoutTasksOfRos2) {
  const auto seen = answer_to();
  ASSERT_TRUE(seen) << to_string(seen.error());
  EXPECT_EQ(*seen, Value::map({{"nodes", Value(Value::List())},
                               {"place", Value::map({{"domain", -1}, {"discovery", ""}})},
                               {"places", Value::list({Value::map({{"domain", -1}, {"discovery", ""}})})},
                               {"tasks", Value::map({})}}));
  EXPECT_EQ(places(), std::vector{Ros2Place()});
}

TEST_F(Ros2LooksTest, AreMadeWhereTheTasksOfTheRobotAre) {
  has({{"a", Value()},
       {"b", in_domain(7, "localhost")},
       {"c", in_domain(7, "localhost")},
       {"d", in_domain(3)}});
  const auto seen = answer_to();
  ASSERT_TRUE(seen) << to_string(seen.error());
  EXPECT_EQ(*seen->find("place"), Value::map({{"domain", 7}, {"discovery", "localhost"}}));
  EXPECT_EQ(*seen->find("places"), Value::list({Value::map({{"domain", 7}, {"discovery", "localhost"}}),
                                                Value::map({{"domain", 3}, {"discovery", ""}})}));
  EXPECT_EQ(*seen->find("tasks")->find("a"), Value::map({}));
  EXPECT_EQ(*seen->find("tasks")->find("d"),
            Value::map({{"domain", 3}, {"discovery", ""}, {"name", "/lidar"}}));
  EXPECT_TRUE(answer_to(R"({"domain": 3})"));
  EXPECT_EQ(places(), (std::vector<Ros2Place>{{7, "localhost"}, {3, ""}}));
}

TEST_F(Ros2LooksTest, AreMadeNowhereElse) {
  has({{"a", in_domain(7)}});
  const auto elsewhere = answer_to(R"({"domain": 8})");
  ASSERT_FALSE(elsewhere);
  EXPECT_EQ(elsewhere.error().code, ErrorCode::NotFound);
  EXPECT_EQ(elsewhere.error().message, "no task of the robot is in domain 8");
  for (const char* wrong :
       {R"({"domain": 233})", R"({"domain": -2})", R"({"domain": 1.5})", R"({"domain": "7"})",
        R"({"domain": 1e300})", R"({"discovery": 3})", R"({"wait": 3})"})
    EXPECT_EQ(answer_to(wrong).error().code, ErrorCode::InvalidArgument) << wrong;
  EXPECT_EQ(places(), std::vector<Ros2Place>());
}

TEST_F(Ros2LooksTest, HaveTheErrorOfTheProgram) {
  sees(fail(ErrorCode::Unavailable, "the program segue-ros2 is not installed"));
  const auto seen = answer_to();
  ASSERT_FALSE(seen);
  EXPECT_EQ(seen.error().message, "the program segue-ros2 is not installed");
  Verbs without(link_);
  EXPECT_EQ(ask(without).get().error().code, ErrorCode::Unsupported);
}

TEST_F(Ros2LooksTest, AreSharedByAllWhoAskMeanwhile) {
  std::vector<std::string> answers;
  int made = 0;
  std::function<void(const std::string&, const std::string&)> begin;
  // Others ask in the midst of the first look.
  Ros2Looks looks(link_, [&](const Ros2Place&, TimePoint) {
    if (++made == 1) {
      begin("second", "{}");
      begin("third", R"({"domain": 3})");
      EXPECT_THAT(answers, ::testing::SizeIs(1));
    }
    return Result<Value>(Value::map({}));
  });
  begin = [&](const std::string& name, const std::string& arguments) {
    const auto command = Command::parse(R"({"id": 1, "verb": "v", "arguments": )" + arguments + "}");
    looks.begin(*command, [&answers, name](const Result<Value>& seen) {
      answers.push_back(name + (seen ? " sees" : ": " + seen.error().message));
    });
  };
  begin("first", "{}");
  EXPECT_THAT(answers, ::testing::ElementsAre(
                           "third: another domain of ROS 2 is being looked at; try again in some seconds",
                           "first sees", "second sees"));
  EXPECT_EQ(made, 1);
  begin("fourth", "{}");
  EXPECT_EQ(made, 2) << "what has ended is not shared any more";
}

TEST_F(Ros2LooksTest, LeaveAllOtherCallsToOthers) {
  Gate goes_on;
  Verbs verbs(link_, {}, {}, [&](const Ros2Place&, TimePoint) {
    EXPECT_TRUE(goes_on.wait());
    return Result<Value>(Value::map({}));
  });
  std::vector<std::future<Result<Value>>> answers;
  for (std::size_t i = 0; i < 2 * Verbs::kMostCalls; ++i) {
    // Those of before may not have left their threads yet; who finds none is answered at once.
    EXPECT_TRUE(eventually([&] {
      auto answer = ask(verbs);
      const bool is_refused = answer.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
      if (!is_refused) answers.push_back(std::move(answer));
      return !is_refused;
    }));
    EXPECT_TRUE(eventually([&] { return status_of(verbs); })) << i;
  }
  goes_on.open();
  for (auto& answer : answers)
    EXPECT_TRUE(answer.get());
}

}  // namespace
}  // namespace segue::web
