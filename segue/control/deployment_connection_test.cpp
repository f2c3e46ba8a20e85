// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>
#include <segue/base/question.hpp>
#include <support/fake_deployment.hpp>
#include <support/random_actions.hpp>

#include <rapidcheck.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <future>
#include <map>
#include <optional>
#include <thread>

namespace segue::control {
namespace {

using model::ActionKind;
using model::TaskId;
using type::Value;

TEST_F(DeploymentTest, AServerThatGoesTakesItsListenerAway) {
  serve();
  EXPECT_EQ(deployment_.listeners_set, 1);
  server_.reset();
  EXPECT_EQ(deployment_.listeners_set, 2);
  deployment_.tell({TaskId("t"), TaskState::Fatal, ""});
}

TEST_F(DeploymentTest, AHangingCallEndsAtItsDeadlineAndOthersAreAnswered) {
  serve();
  const auto process = client();
  const auto deadline = RealClock::instance().now() + std::chrono::milliseconds(50);
  auto hanging =
      std::async(std::launch::async, [&] { return process->call(TaskId("a"), "hang", Value(), deadline); });
  ASSERT_TRUE(deployment_.entered.wait());
  EXPECT_TRUE(process->info());
  EXPECT_TRUE(process->perform_all(std::vector{action_of(ActionKind::Stop, "a")}, soon()).at(0));
  const auto late = hanging.get();
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().code, ErrorCode::DeadlineExceeded);
  EXPECT_TRUE(process->info());
}

TEST_F(DeploymentTest, ADeadlineThatPassesIsAnAnswerForEachAction) {
  serve();
  const auto deadline = RealClock::instance().now() + std::chrono::milliseconds(20);
  const auto late = client()->perform_all(std::vector{action_of(ActionKind::Stop, "wait")}, deadline);
  ASSERT_EQ(late.size(), 1U);
  EXPECT_EQ(late[0].error().message, "nobody let me go");
}

TEST_F(DeploymentTest, GoneIsToldOnceAndCallsAreUnavailable) {
  serve();
  std::atomic<int> gone{0};
  const auto process = client([&] { ++gone; });
  ASSERT_TRUE(process->info());
  EXPECT_EQ(gone, 0);
  server_.reset();
  EXPECT_TRUE(eventually([&] { return gone == 1; }));
  EXPECT_EQ(process->info().error().code, ErrorCode::Unavailable);
  const auto outcomes = process->perform_all(std::vector(3, action_of(ActionKind::Stop, "a")), soon());
  ASSERT_EQ(outcomes.size(), 3U);
  EXPECT_EQ(outcomes[2].error().code, ErrorCode::Unavailable);
  EXPECT_EQ(process->snapshot().error().code, ErrorCode::Unavailable);
  EXPECT_EQ(gone, 1);
}

TEST_F(DeploymentTest, AClientThatLeavesIsNotToldThatTheOtherWent) {
  serve();
  std::atomic<int> gone{0};
  auto process = client([&] { ++gone; });
  const auto reader = process->open_reader({TaskId("a"), "out"}, 1).value();  // keeps the connection
  process.reset();
  server_.reset();
  EXPECT_TRUE(reader->read(1).empty());
  EXPECT_EQ(gone, 0);
}

/// A socket like those that the process server makes: bound and listening before anybody serves.
Descriptor listening_socket(const std::filesystem::path& path) {
  Descriptor socket(::socket(AF_UNIX, SOCK_STREAM, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.native().copy(address.sun_path, sizeof address.sun_path - 1);
  EXPECT_EQ(::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  EXPECT_EQ(::listen(socket.get(), 8), 0);
  return socket;
}

TEST_F(DeploymentTest, AProcessThatIsStillStartingIsWaitedFor) {
  auto listening = listening_socket(socket_);
  auto early = std::async(std::launch::async, [&] { return client()->info(); });
  auto server = Server::serve(std::move(listening), &deployment_);
  ASSERT_TRUE(server) << to_string(server.error());
  EXPECT_TRUE(early.get());
  server->reset();
  EXPECT_TRUE(std::filesystem::exists(socket_));
}

TEST_F(DeploymentTest, AProcessThatNeverStartsIsWaitedForUntilTheDeadline) {
  const auto listening = listening_socket(socket_);
  std::atomic<int> gone{0};
  const auto deadline = RealClock::instance().now() + std::chrono::milliseconds(20);
  const auto late = connect_deployment(socket_, deadline, [&] { ++gone; });
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().code, ErrorCode::DeadlineExceeded);
  EXPECT_EQ(gone, 0);
}

TEST_F(DeploymentTest, AProcessThatDiesWhileItStartsIsUnavailable) {
  auto listening = listening_socket(socket_);
  auto early = std::async(std::launch::async,
                          [&] { return connect_deployment(socket_, soon(), nullptr).error().code; });
  // Once the client's connection waits in the queue, the process ends.
  const Descriptor accepted(::accept(listening.get(), nullptr, nullptr));
  { const Descriptor closing(listening.release()); }
  ::shutdown(accepted.get(), SHUT_RDWR);
  EXPECT_EQ(early.get(), ErrorCode::Unavailable);
}

TEST_F(DeploymentTest, WhatIsNoListeningSocketIsNotServed) {
  const auto refused = Server::serve(memory_with("x"), &deployment_);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(Server::serve(Descriptor(), &deployment_).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(Server::serve(Descriptor(::socket(AF_UNIX, SOCK_STREAM, 0)), &deployment_).error().code,
            ErrorCode::InvalidArgument);
}

TEST_F(DeploymentTest, AnotherKindOfServiceIsAClearError) {
  serve();
  const auto robot = connect(socket_, kLong);
  ASSERT_FALSE(robot);
  EXPECT_EQ(robot.error().code, ErrorCode::Unsupported);
  EXPECT_NE(robot.error().message.find("'robot'"), std::string::npos) << robot.error().message;
  EXPECT_NE(robot.error().message.find("the deployment process"), std::string::npos);
  EXPECT_EQ(connect_processes(socket_, kLong).error().code, ErrorCode::Unsupported);
}

TEST_F(DeploymentTest, WhatIsTooLargeIsRefusedAndTheConnectionLives) {
  serve();
  const auto process = client();
  const Value large(std::string(std::size_t{5} << 20, 'x'));
  EXPECT_EQ(process->set_property(TaskId("a"), "p", large, soon()).error().code,
            ErrorCode::ResourceExhausted);
  EXPECT_EQ(process->call(TaskId("a"), "echo", large, soon()).error().code, ErrorCode::ResourceExhausted);
  const std::vector actions(100'000, action_of(ActionKind::Stop, "a_task_with_a_longer_name"));
  EXPECT_EQ(process->perform_all(actions, soon()).at(99'999).error().code, ErrorCode::ResourceExhausted);
  Value deep(1);
  for (int i = 0; i < 400; ++i)
    deep = Value::list({std::move(deep)});
  EXPECT_EQ(process->call(TaskId("a"), "echo", deep, soon()).error().code, ErrorCode::InvalidArgument);
  EXPECT_TRUE(process->info());
}

}  // namespace
}  // namespace segue::control
