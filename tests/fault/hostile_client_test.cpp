// SPDX-License-Identifier: Apache-2.0
// Hostile clients on the socket of a real deployment process.
#include <segue/base/descriptor.hpp>

#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <random>

#include "deployed_robot.hpp"

namespace segue::testing {
namespace {

class HostileClient : public DeployedRobotTest {
 protected:
  std::filesystem::path socket_of(const std::string& deployment) {
    const model::DeploymentKey key{model::kLocalHost, model::ProcessName(deployment)};
    return process_server::process_socket(launch_.robot, key).value();
  }
  Descriptor connect(const std::string& deployment) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string path = socket_of(deployment);
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    Descriptor client(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    EXPECT_EQ(::connect(client.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    return client;
  }
  /// Sends until everything is accepted, or the process closes or accepts nothing for a second.
  static std::size_t send(const Descriptor& client, std::string_view bytes) {
    std::size_t total = 0;
    while (total < bytes.size()) {
      const auto sent = ::send(client.get(), bytes.data() + total, bytes.size() - total, MSG_NOSIGNAL);
      if (sent > 0) {
        total += static_cast<std::size_t>(sent);
        continue;
      }
      pollfd entry{client.get(), POLLOUT, 0};
      if (errno != EAGAIN || ::poll(&entry, 1, 1000) <= 0) break;
    }
    return total;
  }
  static std::string noise(std::size_t size) {
    std::mt19937 random(7);
    std::string bytes(size, '\0');
    for (char& byte : bytes)
      byte = static_cast<char>(random());
    return bytes;
  }

  const model::Network plain_ = network("plain");
};

TEST_F(HostileClient, GarbageHalfMessagesAndEndlessDataDisturbNobody) {
  switch_to(plain_);
  const pid_t eye = pid_of("eye");
  const Holdings before = holdings_of(eye);
  {
    std::vector<Descriptor> clients;
    for (int i = 0; i < 20; ++i) {
      clients.push_back(connect("eye"));
      send(clients.back(), noise(static_cast<std::size_t>(1) << i));
    }
    clients.push_back(connect("eye"));
    send(clients.back(), std::string("\0\0\0\0\x10\0\0\0half", 12));
    clients.push_back(connect("eye"));
    send(clients.back(),
         std::string("\0\0\0\0\xff\xff\xff\x7f", 8) + std::string(std::size_t{32} << 20, 'x'));
    for (int i = 0; i < 20; ++i)
      clients.push_back(connect("eye"));
    expect_undisturbed();
  }
  EXPECT_EQ(pid_of("eye"), eye);
  switch_to(network("more", "  extra: {component: \"fault::Relay\"}\n", "  other: {tasks: [extra]}\n",
                    "  - beater.out -> extra.in\n"));
  EXPECT_TRUE(eventually([&] { return !has_grown(before, holdings_of(eye)); }))
      << to_string(before) << " have become " << to_string(holdings_of(eye));
  expect_undisturbed();
}

TEST_F(HostileClient, NobodyElseMayConnect) {
  switch_to(plain_);
  struct stat status {};
  ASSERT_EQ(::stat(socket_of("eye").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
  ASSERT_EQ(::stat(socket_of("eye").parent_path().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0700U);
}

}  // namespace
}  // namespace segue::testing
