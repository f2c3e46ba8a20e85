// SPDX-License-Identifier: Apache-2.0
#include <segue/process_server/assignment.hpp>
#include <segue/process_server/launch.hpp>
#include <segue/type/json.hpp>

#include <gmock/gmock.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>

#include "support/random_networks.hpp"

namespace segue::process_server {
namespace {

using ::testing::HasSubstr;

Launch random_launch(std::uint64_t seed) {
  segue::testing::Random random(seed);
  segue::testing::NetworkShape shape;
  shape.attributes = true;
  shape.awkward_text = true;
  Launch launch;
  launch.robot = "rover" + std::to_string(seed % 7);
  launch.deployment = segue::testing::random_deployment(random, shape, static_cast<int>(seed % 5));
  for (std::uint64_t i = seed % 3; i > 0; --i)
    launch.libraries.push_back("library" + std::to_string(i));
  if (seed % 2 == 0) launch.models = {"/models/a b.yaml", "/m"};
  launch.stand_in = seed % 3 == 0;
  launch.only_stand_ins = seed % 5 == 0;
  launch.stand_ins = "stand_ins:\n  default: {configure: 10ms}\n";
  launch.log_level = "debug";
  if (seed % 3 == 1) launch.peers = {"10.0.0.1", "arm.local"};
  launch.memory = {seed % 100, seed, seed / 2};
  return launch;
}

RC_GTEST_PROP(LaunchTest, WhatIsWrittenReadsTheSame, (std::uint64_t seed)) {
  const Launch launch = random_launch(seed);
  const auto text = type::to_json(to_value(launch));
  const auto read = launch_from(type::parse_json(text).value());
  RC_ASSERT(read.has_value());
  RC_ASSERT(*read == launch);
}

RC_GTEST_PROP(AssignmentTest, WhatIsHandedOverArrives, (std::uint64_t seed)) {
  const Assignment assignment{random_launch(seed), "/run/a.sock", "/run/a.log", seed % 5000, 4};
  const auto file = write_assignment(assignment);
  RC_ASSERT(file.has_value());
  const auto read = read_assignment(file->get());
  RC_ASSERT(read.has_value());
  RC_ASSERT(read->launch == assignment.launch);
  RC_ASSERT(read->socket == assignment.socket);
  RC_ASSERT(read->log == assignment.log);
  RC_ASSERT(read->log_size == assignment.log_size);
  RC_ASSERT(read->log_files == assignment.log_files);
}

std::string problem_with(const std::string& json) {
  const auto read = launch_from(type::parse_json(json).value());
  return read ? "" : read.error().message;
}

TEST(LaunchTest, WrongEntriesAreNamed) {
  const std::string good = R"("robot": "r", "deployment": {"process": "p"})";
  EXPECT_EQ(problem_with('{' + good + '}'), "");
  EXPECT_THAT(problem_with("[]"), HasSubstr("must be a map"));
  EXPECT_THAT(problem_with("{}"), HasSubstr("robot"));
  EXPECT_THAT(problem_with(R"({"robot": "r"})"), HasSubstr("process"));
  EXPECT_THAT(problem_with(R"({"robot": "../r", "deployment": {"process": "p"}})"), HasSubstr("'../r'"));
  EXPECT_THAT(problem_with('{' + good + R"(, "libraries": [1]})"), HasSubstr("'libraries'"));
  EXPECT_THAT(problem_with('{' + good + R"(, "libraries": ["/x.so"]})"), HasSubstr("'/x.so'"));
  EXPECT_THAT(problem_with('{' + good + R"(, "models": ["a.yaml"]})"), HasSubstr("absolute"));
  for (const char* peer : {"", "a,b"}) {
    EXPECT_THAT(problem_with('{' + good + R"(, "peers": [")" + peer + R"("]})"),
                HasSubstr("address of a host"));
  }
  EXPECT_THAT(problem_with('{' + good + R"(, "memory": {"payload": -1}})"), HasSubstr("'payload'"));
  EXPECT_THAT(problem_with('{' + good + R"(, "stand_in": "yes"})"), HasSubstr("'stand_in'"));
}

TEST(LaunchTest, AProcessOfAnotherHostNameHasAFileOfItsOwn) {
  const model::DeploymentKey key{model::HostName("onboard"), model::ProcessName("a.b")};
  EXPECT_EQ(key_of_socket("/run/a.b@onboard.sock"), key);
  const model::DeploymentKey local{model::kLocalHost, model::ProcessName("a.b")};
  EXPECT_EQ(key_of_socket("/run/a.b.sock"), local);
  EXPECT_EQ(key_of_socket("/run/a.b.log"), std::nullopt);
  EXPECT_EQ(key_of_socket("/run/a@b@c.sock"), std::nullopt);
}

}  // namespace
}  // namespace segue::process_server
