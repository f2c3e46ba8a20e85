// SPDX-License-Identifier: Apache-2.0
#include "../process/stream.hpp"
#include "remote.hpp"

#include <cstdio>
#include <cstdlib>
#include <thread>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/tcp.h>
#include <sched.h>
#include <sys/socket.h>
#include <unistd.h>

namespace bench {
namespace {

[[noreturn]] void give_up(const std::string& what) {
  std::perror(what.c_str());
  std::_Exit(1);
}

sockaddr_in address_of(const Route& route) {
  constexpr int kFirstPort = 20'000;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(kFirstPort + (::getpgrp() + route.run) % 10'000));
  if (::inet_pton(AF_INET, route.reader.address.c_str(), &address.sin_addr) != 1) give_up("address");
  return address;
}

const sockaddr* generic(const sockaddr_in& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

void at_once(int socket) {
  const int on = 1;
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

int connect_to_reader(const Route& route) {
  const sockaddr_in address = address_of(route);
  for (int i = 0; i < 1000; ++i) {
    const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
    if (::connect(socket, generic(address), sizeof address) == 0) {
      at_once(socket);
      return socket;
    }
    ::close(socket);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  give_up("connect");
}

class Tcp final : public Transport {
 public:
  explicit Tcp(Route route) : route_(std::move(route)) {}
  [[nodiscard]] std::string name() const override { return "TCP"; }
  [[nodiscard]] bool carries(std::size_t) const override { return true; }
  std::unique_ptr<Writer> open(const End& end) override {
    enter(route_.writer);
    return std::make_unique<StreamWriter>(connect_to_reader(route_), end.bytes);
  }
  void read(const End& end) override {
    enter(route_.reader);
    const sockaddr_in address = address_of(route_);
    const int listener = ::socket(AF_INET, SOCK_STREAM, 0);
    const int on = 1;
    ::setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    if (::bind(listener, generic(address), sizeof address) != 0 || ::listen(listener, 1) != 0)
      give_up("listen");
    const int socket = ::accept(listener, nullptr, nullptr);
    at_once(socket);
    read_stream(socket, end);
  }

 private:
  Route route_;
};

}  // namespace

void enter(const Place& place) {
  if (place.name_space.empty()) return;
  const int file = ::open(("/var/run/netns/" + place.name_space).c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0 || ::setns(file, CLONE_NEWNET) != 0) give_up("name space " + place.name_space);
  ::close(file);
}

std::unique_ptr<Transport> make_tcp(const Route& route) {
  return std::make_unique<Tcp>(route);
}

}  // namespace bench
