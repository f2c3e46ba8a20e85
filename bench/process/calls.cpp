// SPDX-License-Identifier: Apache-2.0
#include "calls.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

namespace bench {

std::optional<Summary> byte_there_and_back(std::size_t repeat) {
  const auto ask = [&](const End& end) {
    for (std::size_t i = 0; i < repeat; ++i) {
      char byte = 1;
      const std::int64_t begin = clock_ns();
      if (::write(end.socket, &byte, 1) != 1 || ::read(end.socket, &byte, 1) != 1) return false;
      end.board.add_result(Duration(clock_ns() - begin));
    }
    return true;
  };
  const auto answer = [](const End& end) {
    char byte = 0;
    while (::read(end.socket, &byte, 1) == 1 && ::write(end.socket, &byte, 1) == 1) {
    }
  };
  return run_pair({}, ask, answer);
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
