// SPDX-License-Identifier: Apache-2.0
#include <segue/control/verbs.hpp>
#include <segue/web/browser_session.hpp>
#include <segue/web/test_support.hpp>

namespace segue::web {
namespace {

using type::Value;

class SessionTest : public WebTest {
 protected:
  SessionTest()
      : watching_([this] { return connection()(); }),
        calling_([this] { return connection()(); }),
        hub_(watching_, often_),
        verbs_(calling_) {}

  std::shared_ptr<Session> browser(Role role = Role::Operate) {
    auto session = Session::create(hub_, verbs_, {role, "fake", "somebody"}, [] {});
    EXPECT_EQ(session->next().value_or(""),
              std::string(R"({"role":")") + std::string(to_string(role)) + R"(","robot":"fake"})");
    return session;
  }
  /// The next message that has `key`; others are dropped.
  static Value message(Session& session, const std::string& key) {
    Value found;
    EXPECT_TRUE(eventually([&] {
      while (const auto text = session.next()) {
        const auto value = type::parse_json(*text);
        EXPECT_TRUE(value) << *text;
        if (value && value->find(key) != nullptr) {
          found = *value;
          return true;
        }
      }
      return false;
    })) << key;
    return found;
  }
  static std::string error_code(Session& session, const std::string& text) {
    session.receive(text);
    const Value answer = message(session, "id");
    const Value* error = answer.find("error");
    return error == nullptr ? "" : error->find("code")->as_string();
  }

  const Hub::Periods often_{.snapshots = std::chrono::milliseconds(20),
                            .ports = std::chrono::milliseconds(20)};
  RobotLink watching_;
  RobotLink calling_;
  Hub hub_;
  Verbs verbs_;
};

TEST_F(SessionTest, VerbsAreAnsweredUnderTheirNumber) {
  const auto session = browser();
  session->receive(
      R"({"id": 7, "verb": "call", "arguments": {"task": "t", "operation": "echo", "value": [1, "<b>"]}})");
  EXPECT_EQ(message(*session, "id"), Value::map({{"id", 7}, {"result", Value::list({1, "<b>"})}}));
  session->receive(R"({"id": 8, "verb": "set", "arguments": {"task": "t", "property": "p", "yaml": "0.5"}})");
  EXPECT_EQ(message(*session, "id"), Value::map({{"id", 8}, {"result", Value()}}));
  EXPECT_EQ(robot_.last_set(), Value::map({{"task", "t"}, {"property", "p"}, {"value", 0.5}}));
  session->receive(R"({"id": 9, "verb": "switch", "arguments": {"controller": "c", "force": true}})");
  const Value switched = message(*session, "id");
  EXPECT_EQ(*switched.find("result")->find("who"), Value("somebody"));
  EXPECT_EQ(*switched.find("result")->find("dry_run"), Value(false));
  session->receive(R"({"id": 11, "verb": "cancel", "arguments": {"request": 5}})");
  const Value cancelled = message(*session, "id");
  EXPECT_EQ(*cancelled.find("result")->find("request"), Value(5));
  EXPECT_EQ(*cancelled.find("result")->find("who"), Value("somebody"));
  session->receive(R"({"id": 10, "verb": "diff", "arguments": {"controller": "c"}})");
  EXPECT_EQ(*message(*session, "id").find("result")->find("dry_run"), Value(true));
}

TEST_F(SessionTest, ABrowserIsToldThatThereIsRos2) {
  const auto session = Session::create(hub_, verbs_, {Role::Observe, "fake", "somebody", true}, [] {});
  EXPECT_EQ(session->next().value_or(""), R"({"role":"observe","robot":"fake","ros2":true})");
}

TEST_F(SessionTest, EachVerbNeedsItsRole) {
  const std::vector<std::pair<std::string, control::Verb>> verbs = {
      {"status", control::Verb::Status},
      {"task", control::Verb::Task},
      {"events", control::Verb::Events},
      {"past", control::Verb::Past},
      {"diff", control::Verb::Plan},
      {"plan_files", control::Verb::Plan},
      {"switch", control::Verb::Switch},
      {"apply_files", control::Verb::Apply},
      {"repair", control::Verb::Repair},
      {"prepare", control::Verb::Prepare},
      {"cancel", control::Verb::Cancel},
      {"mission", control::Verb::SendCommand},
      {"mission_form", control::Verb::LookAtFiles},
      {"start_mission", control::Verb::Lease},
      {"stop", control::Verb::Stop},
      {"release", control::Verb::ReleaseStop},
      {"set", control::Verb::Set},
      {"call", control::Verb::Call},
      {"write", control::Verb::Write},
      {"files", control::Verb::LookAtFiles},
      {"read_file", control::Verb::LookAtFiles},
      {"check_file", control::Verb::LookAtFiles},
      {"models", control::Verb::LookAtFiles},
      {"libraries", control::Verb::LookAtFiles},
      {"semantic_data", control::Verb::LookAtFiles},
      {"check_semantic_data", control::Verb::LookAtFiles},
      {"look_at_ros2", control::Verb::LookAtRos2},
      {"save_semantic_data", control::Verb::ChangeFiles},
      {"save_file", control::Verb::ChangeFiles},
      {"create_file", control::Verb::ChangeFiles},
      {"rename_file", control::Verb::ChangeFiles},
      {"delete_file", control::Verb::ChangeFiles}};
  EXPECT_EQ(verbs.size(), verb_forms().size()) << "a verb is not in this list";
  for (const Role role : {Role::Observe, Role::Operate, Role::Administer}) {
    const auto session = browser(role);
    for (const auto& [name, verb] : verbs) {
      const bool refused =
          error_code(*session, R"({"id": 1, "verb": ")" + name + "\"}") == "permission-denied";
      EXPECT_EQ(refused, role < control::role_for(verb)) << to_string(role) << " asks " << name;
    }
    for (const std::string name : {"switch", "apply_files"}) {
      const std::string controller = name == "switch" ? R"("controller": "c", )" : "";
      const bool refused =
          error_code(*session, R"({"id": 1, "verb": ")" + name + R"(", "arguments": {)" + controller +
                                   R"("take_over": true}})") == "permission-denied";
      EXPECT_EQ(refused, role != Role::Administer) << to_string(role) << " takes over by " << name;
    }
  }
}

TEST_F(SessionTest, AnObserverOnlyLooks) {
  const auto session = browser(Role::Observe);
  const Value refused = [&] {
    session->receive(R"({"id": 1, "verb": "set", "arguments": {"task": "t", "property": "p", "yaml": "1"}})");
    return message(*session, "id");
  }();
  EXPECT_EQ(refused.find("error")->find("message")->as_string(),
            "this browser may only observe, not set, which needs the role operate");
  EXPECT_EQ(robot_.last_set(), Value());
}

TEST_F(SessionTest, AnybodyMayAskAboutThePast) {
  const auto session = browser(Role::Observe);
  session->receive(R"({"id": 3, "verb": "past", "arguments": {"ask": "at", "time_s": 12.5}})");
  EXPECT_EQ(*message(*session, "id").find("result"), Value::map({{"ask", "at"}, {"time_s", 12.5}}));
  EXPECT_EQ(error_code(*session, R"({"id": 1, "verb": "past", "arguments": {"path": "/etc/passwd"}})"),
            "invalid-argument");
}

TEST_F(SessionTest, TheClockOfTheRobotComesWithThatOfThePorts) {
  using Seconds = std::chrono::duration<double>;
  const auto session = browser(Role::Observe);
  const Seconds before = monotonic_now().time_since_epoch();
  session->receive(R"({"id": 3, "verb": "past", "arguments": {"ask": "clock"}})");
  const Value clock = *message(*session, "id").find("result");
  const Seconds after = monotonic_now().time_since_epoch();
  EXPECT_EQ(clock.find("now_s")->as_double(), 1.8e9);
  const double studio = clock.find("studio_s")->as_double();
  const double within = clock.find("within_s")->as_double();
  EXPECT_GE(studio - within, before.count() - 1e-6);  // a double has microseconds
  EXPECT_LE(studio + within, after.count() + 1e-6);
}

TEST_F(SessionTest, WrongMessagesAreAnsweredByErrors) {
  const auto session = browser();
  EXPECT_EQ(error_code(*session, "{"), "parse-error");
  EXPECT_EQ(error_code(*session, R"({"id": 1, "verb": "explode"})"), "not-found");
  EXPECT_EQ(error_code(*session, R"({"id": 1, "verb": "shut_down"})"), "not-found");
  EXPECT_EQ(error_code(*session, R"({"id": 1, "verb": "switch"})"), "invalid-argument");
  EXPECT_EQ(error_code(*session, R"({"id": 1, "verb": "cancel", "arguments": {"request": -1}})"),
            "invalid-argument");
  EXPECT_EQ(error_code(*session, R"({"id": 1, "verb": "status", "arguments": {"x": 1}})"),
            "invalid-argument");
  EXPECT_EQ(error_code(*session, R"({"id": 1, "verb": "subscribe", "arguments": {"document": "../etc"}})"),
            "not-found");
  EXPECT_EQ(
      error_code(*session,
                 R"({"id": 1, "verb": "set", "arguments": {"task": "t", "property": "p", "yaml": "["}})"),
      "parse-error");
  EXPECT_EQ(error_code(*session, R"({"id": 1, "verb": "status"})"), "");
}

TEST_F(SessionTest, ChangesFollowTheFirstValue) {
  const auto session = browser();
  session->receive(R"({"id": 1, "verb": "subscribe", "arguments": {"document": "status"}})");
  const Value first = message(*session, "document");
  EXPECT_EQ(*first.find("value"), Value::map({{"robot", "fake"}}));
  EXPECT_EQ(*first.find("skipped"), Value(0));
  robot_.show(Value::map({{"robot", "fake"}, {"state", "busy"}}));
  const Value second = message(*session, "document");
  EXPECT_EQ(second.find("value"), nullptr);
  EXPECT_EQ(*second.find("change"), Value::map({{"set", Value::map({{"state", "busy"}})}}));
  session->receive(R"({"id": 2, "verb": "unsubscribe", "arguments": {"document": "status"}})");
  EXPECT_EQ(*message(*session, "id").find("id"), Value(2));
  EXPECT_EQ(hub_.newest("status"), nullptr);
}

TEST_F(SessionTest, WhoIsSlowGetsTheNewestAndIsTold) {
  const auto slow = browser();
  const auto quick = browser();
  for (const auto& session : {slow, quick})
    session->receive(R"({"id": 1, "verb": "subscribe", "arguments": {"document": "status"}})");
  message(*slow, "document");
  for (int number = 1; number <= 5; ++number) {
    robot_.show(Value::map({{"robot", "fake"}, {"number", number}}));
    for (bool seen = false; !seen;) {
      const Value update = message(*quick, "document");
      const Value* change = update.find("change");
      seen = change != nullptr && *change->find("set")->find("number") == Value(number);
    }
  }
  const Value update = message(*slow, "document");
  EXPECT_EQ(*update.find("change"), Value::map({{"set", Value::map({{"number", 5}})}}));
  EXPECT_EQ(*update.find("skipped"), Value(4));
  EXPECT_EQ(slow->next(), std::nullopt) << "nothing piles up";
}

TEST_F(SessionTest, WhoAsksWithoutReadingIsFull) {
  const auto session = browser();
  for (std::size_t count = 0; count < Session::kMostAnswers; ++count) {
    EXPECT_FALSE(session->is_full());
    session->receive("no command");
  }
  EXPECT_TRUE(session->is_full());
  session->next();
  EXPECT_FALSE(session->is_full());
}

TEST_F(SessionTest, TooManyCallsAndDocumentsAreRefused) {
  const auto session = browser();
  for (std::size_t count = 0; count < Verbs::kMostCalls; ++count)
    session->receive(
        R"({"id": 1, "verb": "call", "arguments": {"task": "t", "operation": "wait", "value": []}})");
  EXPECT_EQ(error_code(*session, R"({"id": 2, "verb": "status"})"), "resource-exhausted");
  robot_.release.open();
  for (std::size_t count = 0; count < Verbs::kMostCalls; ++count)
    EXPECT_EQ(*message(*session, "id").find("result"), Value("released"));
  for (std::size_t count = 0; count < Session::kMostDocuments; ++count) {
    EXPECT_EQ(error_code(*session, R"({"id": 3, "verb": "subscribe", "arguments": {"document": "task/t)" +
                                       std::to_string(count) + "\"}}"),
              "");
  }
  EXPECT_EQ(error_code(*session, R"({"id": 3, "verb": "subscribe", "arguments": {"document": "status"}})"),
            "resource-exhausted");
}

TEST_F(SessionTest, CallsThatTakeLongKeepNobodyFromStoppingTheRobot) {
  const auto session = browser();
  for (std::size_t count = 0; count < Verbs::kMostCalls; ++count)
    session->receive(
        R"({"id": 1, "verb": "call", "arguments": {"task": "t", "operation": "wait", "value": []}})");
  EXPECT_EQ(error_code(*session, R"({"id": 2, "verb": "status"})"), "resource-exhausted");
  EXPECT_EQ(error_code(*session, R"({"id": 3, "verb": "stop"})"), "");
  robot_.release.open();
}

TEST_F(SessionTest, AMissionIsPausedWhileItRuns) {
  const auto session = browser();
  const std::string pause = R"({"id": 1, "verb": "mission", "arguments": {"what": "pause"}})";
  EXPECT_EQ(error_code(*session, pause), "not-found") << "none has run";
  robot_.show_mission(1, "running", 1, Value());
  EXPECT_EQ(error_code(*session, pause), "");
  EXPECT_EQ(
      error_code(*session, R"({"id": 1, "verb": "mission", "arguments": {"what": "step", "how": "over"}})"),
      "");
  const auto asked = robot_.lease("a test").value()->asked().value();
  ASSERT_EQ(asked.size(), 2U);
  EXPECT_EQ(asked[0], (control::HolderRequest{1, "pause", Value::map({})}));
  EXPECT_EQ(asked[1], (control::HolderRequest{2, "step", Value::map({{"how", "over"}})}));
  robot_.show_mission(1, "ended", 2, Value());
  EXPECT_EQ(error_code(*session, pause), "not-found");
}

TEST_F(SessionTest, ABrowserThatIsGoneGetsNoAnswer) {
  auto session = browser();
  session->receive(
      R"({"id": 1, "verb": "call", "arguments": {"task": "t", "operation": "wait", "value": []}})");
  session->receive(R"({"id": 2, "verb": "subscribe", "arguments": {"document": "status"}})");
  ASSERT_TRUE(robot_.entered.wait());
  session.reset();
  EXPECT_TRUE(eventually([&] { return hub_.newest("status") == nullptr; }));
  robot_.release.open();
}

}  // namespace
}  // namespace segue::web
