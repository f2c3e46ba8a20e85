// SPDX-License-Identifier: Apache-2.0
#include "calls.hpp"

#include <segue/base/descriptor.hpp>

#include <arpa/inet.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

namespace bench {

namespace {

bool ask(int socket, Board& board, std::size_t repeat) {
  for (std::size_t i = 0; i < repeat; ++i) {
    char byte = 1;
    const std::int64_t begin = clock_ns();
    if (::write(socket, &byte, 1) != 1 || ::read(socket, &byte, 1) != 1) return false;
    board.add_result(Duration(clock_ns() - begin));
  }
  return true;
}

void answer(int socket) {
  char byte = 0;
  while (::read(socket, &byte, 1) == 1 && ::write(socket, &byte, 1) == 1) {
  }
}

std::optional<Summary> over_tcp(std::size_t repeat) {
  const segue::Descriptor listener(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  socklen_t size = sizeof address;
  if (::bind(listener.get(), generic, size) != 0 || ::listen(listener.get(), 1) != 0 ||
      ::getsockname(listener.get(), generic, &size) != 0) {
    return std::nullopt;
  }
  const auto asking = [&](const End& end) {
    const segue::Descriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    return ::connect(socket.get(), generic, size) == 0 && ask(socket.get(), end.board, repeat);
  };
  const auto answering = [&](const End&) {
    const segue::Descriptor socket(::accept(listener.get(), nullptr, nullptr));
    answer(socket.get());
  };
  return run_pair({}, asking, answering);
}

}  // namespace

std::optional<Summary> byte_there_and_back(Way way, std::size_t repeat) {
  if (way == Way::Tcp) return over_tcp(repeat);
  return run_pair(
      {}, [&](const End& end) { return ask(end.socket, end.board, repeat); },
      [](const End& end) { answer(end.socket); });
}

Summary bare_spawn(std::size_t repeat) {
  return measure(repeat, [] {
    char name[] = "true";
    char* arguments[] = {name, nullptr};
    pid_t pid = -1;
    if (::posix_spawn(&pid, "/bin/true", nullptr, nullptr, arguments, environ) != 0) {
      std::perror("posix_spawn /bin/true");
      std::exit(1);
    }
    ::waitpid(pid, nullptr, 0);
  });
}

}  // namespace bench
