// SPDX-License-Identifier: Apache-2.0
//
// Somebody who may only observe tries everything. SEGUE_OBSERVER_CALLS says how often at each server (1000),
// SEGUE_OBSERVER_SEED with which values (1).
#include <segue/base/log.hpp>
#include <segue/concurrent/thread.hpp>
#include <segue/control/verbs.hpp>
#include <segue/type/json.hpp>
#include <segue/web/page_verbs.hpp>
#include <support/browser.hpp>
#include <support/number_from.hpp>

#include <doors/hostile_values.hpp>
#include <doors/observed_robot.hpp>
#include <doors/rpc_door.hpp>

#include <gmock/gmock.h>

#include <atomic>
#include <map>
#include <optional>
#include <set>
#include <thread>

namespace segue::doors {
namespace {

using control::Role;
using segue::testing::Browser;
using segue::testing::number_from;
using ::testing::HasSubstr;
using ::testing::Not;
using type::Value;

using Names = std::set<std::string>;

/// "open_port" -> "openPort", as the schema has it.
std::string in_schema(std::string_view verb) {
  std::string name;
  for (std::size_t i = 0; i < verb.size(); ++i) {
    const bool is_next_word = verb[i] == '_' && i + 1 < verb.size();
    name += is_next_word ? static_cast<char>(verb[++i] - 'a' + 'A') : verb[i];
  }
  return name;
}

/// Of files, which only pages ask.
bool is_of_files(control::Verb verb) {
  return verb >= control::Verb::LookAtFiles;
}

/// Somebody else who uses the robot all the time, and must be served.
class Operator {
 public:
  explicit Operator(const ObservedRobot& robot)
      : connection_(control::connect(robot.endpoint("robot", "otto"), kAnswerTime).value()),
        thread_([this](const std::stop_token& stop) {
          while (!stop.stop_requested()) {
            const auto status = connection_->status();
            status ? ++served_ : ++refused_;
          }
        }) {}
  /// How many requests were served until now, if all were.
  int served() {
    thread_ = {};
    return refused_ == 0 ? served_.load() : -refused_.load();
  }

 private:
  std::unique_ptr<control::RobotService> connection_;
  std::atomic<int> served_{0};
  std::atomic<int> refused_{0};
  std::jthread thread_;
};

class Observer : public ::testing::Test {
 protected:
  Observer() {
    for (const std::string& name : robot_.known_names())
      values_.learn(name);
    values_.learn(robot_.lease());
  }
  void TearDown() override {
    EXPECT_GT(otto_->served(), 0) << "others were served all the time";
    EXPECT_EQ(robot_.state(), before_);
    otto_.reset();
    set_log_sink({});
  }

  /// Calls functions of a server at random; all but `permitted` are refused.
  void try_all(std::string_view kind, const Names& permitted) {
    auto door = RpcDoor::open(robot_.endpoint(kind, "olga"), kind);
    ASSERT_TRUE(door) << to_string(door.error());
    std::vector<std::string> functions = door->functions();
    EXPECT_THAT(functions, ::testing::IsSupersetOf(permitted)) << "of the schema";
    for (int number = 0; number < calls_; ++number) {
      const std::string& function = functions.at(static_cast<std::size_t>(number) % functions.size());
      const auto answer = door->call(function, values_);
      ASSERT_TRUE(answer) << function << ": " << to_string(answer.error());
      expect_no_secret(answer->text, function);
      const bool is_refused = answer->code == "permission-denied";
      EXPECT_TRUE(is_refused || permitted.contains(function)) << function << ": " << answer->code;
      if (!is_refused) answered_.insert(function);
    }
    EXPECT_THAT(answered_, ::testing::ContainerEq(permitted));
  }
  static void expect_no_secret(const std::string& text, const std::string& what) {
    EXPECT_THAT(text, Not(HasSubstr(ObservedRobot::kSecret))) << what;
    EXPECT_THAT(text, Not(HasSubstr("root:x:0:"))) << what << " has /etc/passwd";
    EXPECT_THAT(text, Not(HasSubstr("PRIVATE KEY"))) << what;
  }

  const int calls_ = number_from("SEGUE_OBSERVER_CALLS", 1000);
  HostileValues values_{static_cast<std::uint64_t>(number_from("SEGUE_OBSERVER_SEED", 1))};
  const bool is_silent_ = (set_log_sink([](auto&&...) {}), true);
  ObservedRobot robot_;
  const std::string before_ = robot_.state();
  std::optional<Operator> otto_{std::in_place, robot_};
  Names answered_;
};

TEST_F(Observer, ChangesNothingAtTheDoorOfTheRobot) {
  Names permitted;
  for (const control::VerbRule& rule : control::kVerbRules) {
    if (rule.role == Role::Observe && !is_of_files(rule.verb)) permitted.insert(in_schema(rule.name));
  }
  try_all("robot", permitted);
}

TEST_F(Observer, ChangesNothingAtTheDoorOfTheHost) {
  try_all("host", {"info", "clock", "robots", "log"});
}

TEST_F(Observer, ChangesNothingAtTheDoorOfTheProcessServer) {
  try_all("processes", {"processes", "listen"});
}

/// A message of a page: one of the verbs, with some of its arguments or with none that it has.
Value message_of(const web::VerbForm& form, int id, HostileValues& values) {
  type::ValueMap arguments;
  for (const std::string& name : form.arguments) {
    const bool is_text = values.below(8) != 0;
    if (values.below(8) == 0) continue;
    if (name == "timeout_s") {
      arguments.set(name, 0.05);
    } else {
      arguments.set(name, is_text ? Value(values.text()) : values.value());
    }
  }
  if (values.below(10) == 0) arguments.set(values.text(), values.value());
  return Value::map({{"id", id}, {"verb", form.name}, {"arguments", std::move(arguments)}});
}

TEST_F(Observer, ChangesNothingThroughThePageOfTheStudio) {
  std::vector<web::VerbForm> forms = web::verb_forms();
  for (const char* name : {"subscribe", "unsubscribe"})
    forms.push_back({.name = name, .verb = control::Verb::Status, .arguments = {"document"}});
  Browser page(robot_.studio_port(), robot_.enrolled(), "olga");
  ASSERT_TRUE(page.enter());
  for (int number = 0; number < calls_ / 5; ++number) {
    const web::VerbForm& form = forms.at(static_cast<std::size_t>(number) % forms.size());
    const auto answer = page.ask(type::to_json(message_of(form, number, values_), -1));
    ASSERT_TRUE(answer) << form.name;
    expect_no_secret(type::to_json(*answer, -1), form.name);
    const Value* error = answer->find("error");
    const bool is_refused = error != nullptr && *error->find("code") == Value("permission-denied");
    EXPECT_TRUE(is_refused || control::role_for(form.verb) == Role::Observe) << form.name;
    if (!is_refused) answered_.insert(form.name);
  }
  for (const web::VerbForm& form : forms)
    EXPECT_EQ(answered_.contains(form.name), control::role_for(form.verb) == Role::Observe) << form.name;
}

TEST_F(Observer, SeesNoFileThroughARequestForAPage) {
  const std::string end = "\r\nConnection: close\r\nHost: left:" + std::to_string(robot_.studio_port());
  for (int number = 0; number < calls_ / 20; ++number) {
    std::string target = values_.text() + "/" + values_.text();
    std::erase_if(target, [](char c) { return c == '\0' || c == '\n' || c == '\r' || c == ' '; });
    Browser browser(robot_.studio_port(), robot_.enrolled(), "olga");
    const std::string verb = values_.flag() ? "GET" : values_.flag() ? "PUT" : "DELETE";
    const std::string answer =
        browser.exchange(verb + " /" + target.substr(0, 20'000) + " HTTP/1.1" + end +
                         "\r\nCookie: segue=" + values_.text().substr(0, 20) + "\r\n\r\n");
    EXPECT_FALSE(browser.is_late()) << target;
    expect_no_secret(answer, target);
  }
}

}  // namespace
}  // namespace segue::doors
