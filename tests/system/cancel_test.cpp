// SPDX-License-Identifier: Apache-2.0
#include "system_test.hpp"

namespace segue::testing {
namespace {

using type::Value;
using CancelTest = SystemTest;

/// Waits until a request is in that state, and returns its number.
std::uint64_t wait_for_request(const std::function<Value()>& status, const std::string& state) {
  std::uint64_t number = 0;
  const bool came = eventually([&] {
    const Value now = status();
    for (const Value& request : now.find("requests")->as_list()) {
      if (*request.find("state") == Value(state)) number = request.find("request")->as_uint();
    }
    return number != 0;
  });
  EXPECT_TRUE(came) << "no request is in " << state;
  return number;
}

TEST_F(CancelTest, CtrlCUndoesTheSwitchAndTheJournalHasWhoDidIt) {
  ASSERT_EQ(segue({"init", "rover"}).status, 0);
  write("rover/robot.yaml",
        "robot: rover\ncontrollers: [controllers/*.yaml]\n");  // without libraries: stand-ins
  write("slow.yaml", "stand_ins: {guard: {configure: 4s}, default: {rate: 1}}\n");
  start({"--controller", "explore", "--stand-ins", "slow.yaml"});
  ASSERT_TRUE(eventually([&] { return json({"status"}).find("requests")->as_list().empty(); }));
  const auto nothing = segue({"cancel"});
  EXPECT_EQ(nothing.status, 1);
  EXPECT_NE(nothing.errors.find("there is nothing to cancel"), std::string::npos) << nothing.errors;

  Process going(command({"switch", "go_to", "--format", "json"}), folder_);
  const auto number = wait_for_request([this] { return json({"status"}); }, "prepare");
  going.signal(SIGINT);
  const auto again = json({"cancel", "--request", std::to_string(number)});
  EXPECT_EQ(*again.find("outcome"), Value("cancelled"));
  const auto ended = going.wait();
  EXPECT_EQ(ended.status, 1) << ended.errors;
  EXPECT_NE(ended.errors.find("cancelling"), std::string::npos) << ended.errors;
  const auto result = type::parse_json(ended.output);
  ASSERT_TRUE(result) << ended.output;
  EXPECT_EQ(*result->find("outcome"), Value("cancelled"));
  EXPECT_EQ(*result->find("undo")->find("restored"), Value(true));
  EXPECT_EQ(controller(), "explore");

  EXPECT_EQ(segue({"cancel", "--request", std::to_string(number)}).status, 1) << "it has ended";
  EXPECT_EQ(segue({"cancel", "--request", "-3"}).status, 2);
  const auto past = json({"history", "--all"}).as_list().back();
  EXPECT_EQ(*past.find("outcome"), Value("cancelled"));
  EXPECT_EQ(*past.find("undone"), Value("restored"));
  EXPECT_NE(past.find("cancelled_by")->as_string().find("segue "), std::string::npos);
}

}  // namespace
}  // namespace segue::testing
