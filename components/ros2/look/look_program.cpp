// SPDX-License-Identifier: Apache-2.0
#include "look.hpp"

#include <segue/base/log.hpp>
#include <segue/base/result.hpp>
#include <segue/type/json.hpp>

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <thread>

/// The program segue-ros2, which the command `segue` starts, so that only this process loads Fast DDS. Its
/// argument is a request in JSON (parse_look()), its output the result or {error: {code, message}}. It ends
/// early when its standard input does.
namespace {

using segue::type::Value;

Value result_of(const char* request, const std::stop_token& stop) {
  const auto run = [&]() -> segue::Result<Value> {
    const auto value = segue::type::parse_json(request);
    if (!value) return value.error();
    const auto parsed = ros2::parse_look(*value);
    if (!parsed) return parsed.error();
    return ros2::look(*parsed, stop);
  };
  auto result = run();
  if (result) return std::move(*result);
  return Value::map({{"error", Value::map({{"code", to_string(result.error().code)},
                                           {"message", segue::to_string(result.error())}})}});
}

/// Whoever has started this program has gone; or the program is done.
void wait_for_end_of_input(int done) {
  char ignored[64];
  pollfd both[] = {{STDIN_FILENO, POLLIN, 0}, {done, POLLIN, 0}};
  for (;;) {
    if (::poll(both, 2, -1) < 0 && errno != EINTR) return;
    if ((both[1].revents & POLLIN) != 0) return;
    if (both[0].revents != 0 && ::read(STDIN_FILENO, ignored, sizeof ignored) <= 0) return;
  }
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::fputs("segue-ros2 is started by `segue ros2` and `segue import ros2`, not by hand\n", stderr);
    return 2;
  }
  std::signal(SIGPIPE, SIG_IGN);
  try {
    std::stop_source stop;
    const int done = ::eventfd(0, EFD_CLOEXEC);
    std::thread input([&] {
      wait_for_end_of_input(done);
      stop.request_stop();
    });
    const std::string text = segue::type::to_json(result_of(arguments[1], stop.get_token()), 0);
    const std::uint64_t one = 1;
    static_cast<void>(::write(done, &one, sizeof one));
    input.join();
    const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
    return written && std::fflush(stdout) == 0 ? 0 : 1;
  } catch (const std::exception& exception) {
    std::fprintf(stderr, "error: segue-ros2: %s\n", exception.what());
    return 1;
  }
}
