// SPDX-License-Identifier: Apache-2.0
#include <segue/base/lock_file.hpp>
#include <segue/rpc/detail/socket.hpp>
#include <support/ending_process.hpp>
#include <support/fake_robot_service.hpp>

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <unistd.h>

#include <fstream>
#include <future>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace segue::control {
namespace {

mode_t mode_of(const std::filesystem::path& path) {
  struct stat status {};
  EXPECT_EQ(::stat(path.c_str(), &status), 0) << path;
  return status.st_mode & 0777;
}

sockaddr_un address_of(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.native().copy(address.sun_path, sizeof address.sun_path - 1);
  return address;
}

Descriptor bind_socket(const std::filesystem::path& path) {
  Descriptor socket(::socket(AF_UNIX, SOCK_STREAM, 0));
  const sockaddr_un address = address_of(path);
  EXPECT_EQ(::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  return socket;
}

/// Makes the files that a killed server leaves behind.
void leave_stale_socket(const std::filesystem::path& path) {
  bind_socket(path);
  std::ofstream(std::filesystem::path(path) += ".lock");
}

TEST_F(ControlTest, SocketAndFolderAreOnlyForTheirOwner) {
  serve();
  EXPECT_EQ(mode_of(socket_), 0600U);
  EXPECT_EQ(mode_of(socket_.parent_path()), 0700U);
  ::chmod(socket_.parent_path().c_str(), 0777);
  ASSERT_TRUE(socket_folder());
  EXPECT_EQ(mode_of(socket_.parent_path()), 0700U);
}

TEST_F(ControlTest, WhoeverConnectsToAServerThatIsSilentIsToldHowLongThatWasTried) {
  const Descriptor silent = bind_socket(socket_);
  ASSERT_EQ(::listen(silent.get(), 1), 0);
  const auto connected = connect(socket_, std::chrono::milliseconds(20));
  ASSERT_FALSE(connected);
  EXPECT_EQ(connected.error().code, ErrorCode::DeadlineExceeded);
  EXPECT_THAT(connected.error().message, ::testing::EndsWith("did not answer within 20 ms"));
}

/// Connects as another user. The system call itself, since the library's function changes all threads.
Descriptor connect_as(uid_t user, const std::filesystem::path& path) {
  const sockaddr_un address = address_of(path);
  Descriptor socket(::socket(AF_UNIX, SOCK_STREAM, 0));
  EXPECT_EQ(::syscall(SYS_setresuid, -1, user, -1), 0);
  EXPECT_EQ(::connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  EXPECT_EQ(::syscall(SYS_setresuid, -1, 0, -1), 0);
  return socket;
}

using ControlWherePossible = ControlTest;

TEST_F(ControlTest, WhoeverConnectsMayStop) {
  const Descriptor silent = bind_socket(socket_);
  ASSERT_EQ(::listen(silent.get(), 0), 0);
  std::vector<Descriptor> queue;
  for (const bool is_full : {false, true}) {
    while (is_full && queue.size() < 8) {
      queue.emplace_back(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0));
      const sockaddr_un address = address_of(socket_);
      ::connect(queue.back().get(), reinterpret_cast<const sockaddr*>(&address), sizeof address);
    }
    std::stop_source stop;
    auto waiting = std::async(std::launch::async,
                              [&] { return connect(socket_, std::chrono::hours(1), stop.get_token()); });
    stop.request_stop();
    const auto connected = waiting.get();
    ASSERT_FALSE(connected);
    EXPECT_EQ(connected.error().code, ErrorCode::Cancelled) << to_string(connected.error());
  }
}

TEST_F(ControlWherePossible, AnotherUserIsTurnedAwayEvenIfTheFilesLetHimIn) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can be somebody else";
  serve();
  ::chmod(folder_.c_str(), 0755);
  ::chmod(socket_.parent_path().c_str(), 0755);
  ::chmod(socket_.c_str(), 0777);
  constexpr uid_t kNobody = 65534;
  const Descriptor stranger = connect_as(kNobody, socket_);
  char byte = 0;
  EXPECT_EQ(::recv(stranger.get(), &byte, 1, 0), 0) << "the server hangs up without a word";
  EXPECT_TRUE(client()->status());
}

TEST_F(ControlTest, AFolderThatIsALinkIsRefused) {
  std::filesystem::remove_all(socket_.parent_path());
  std::filesystem::create_directory(folder_ / "elsewhere");
  std::filesystem::create_symlink(folder_ / "elsewhere", socket_.parent_path());
  EXPECT_EQ(socket_folder().error().code, ErrorCode::PermissionDenied);
}

TEST_F(ControlTest, ASecondServerOnTheSameSocketIsRefused) {
  serve();
  FakeRobotService other;
  const auto second = Server::listen(socket_, &other);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::AlreadyExists);
  EXPECT_TRUE(client()->status());
}

TEST_F(ControlTest, AStaleSocketIsReplaced) {
  leave_stale_socket(socket_);
  EXPECT_EQ(connect(socket_).error().code, ErrorCode::Unavailable);
  serve();
  EXPECT_TRUE(client()->status());
}

TEST_F(ControlTest, AServerThatIsEndingIsWaitedFor) {
  leave_stale_socket(socket_);
  const testing::EndingProcess killed;
  std::optional<Descriptor> lock = try_lock(lock_of(socket_)).value();
  ASSERT_TRUE(lock && write_record(lock->get(), {killed.pid(), "0.0.1"}));
  std::jthread end([&] { lock.reset(); });
  serve();
  EXPECT_TRUE(client()->status());
}

TEST_F(ControlTest, AServerThatEndsLeavesNothingBehind) {
  serve();
  server_.reset();
  EXPECT_TRUE(std::filesystem::is_empty(socket_.parent_path()));
  serve();
  EXPECT_TRUE(client()->status());
}

TEST_F(ControlTest, RunningRobotsAreThoseThatAnswer) {
  EXPECT_TRUE(running_robots().empty());
  leave_stale_socket(socket_path("dead").value());
  serve();
  FakeRobotService other;
  const auto second = Server::listen(socket_path("a_second").value(), &other);
  ASSERT_TRUE(second);
  EXPECT_EQ(running_robots(), (std::vector<std::string>{"a_second", "fake"}));
  EXPECT_FALSE(std::filesystem::exists(socket_path("dead").value()));
}

TEST_F(ControlTest, NobodyThereIsUnavailable) {
  EXPECT_EQ(connect(socket_).error().code, ErrorCode::Unavailable);
}

TEST_F(ControlTest, ANameThatIsAPathIsNoRobot) {
  EXPECT_EQ(socket_path("../other").error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(socket_path("").error().code, ErrorCode::InvalidArgument);
}

TEST_F(ControlTest, APathThatIsTooLongForASocketSaysWhatToDo) {
  const auto failed = Server::listen(folder_ / std::string(120, 'x'), &robot_);
  ASSERT_FALSE(failed);
  EXPECT_NE(failed.error().message.find("XDG_RUNTIME_DIR"), std::string::npos);
}

}  // namespace
}  // namespace segue::control
