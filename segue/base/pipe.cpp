// SPDX-License-Identifier: Apache-2.0
#include <segue/base/error.hpp>
#include <segue/base/pipe.hpp>

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>

namespace segue {

namespace {

/// In which it is looked whether what is read is still wanted.
constexpr Duration kReadPeriod = std::chrono::milliseconds(100);

}  // namespace

Result<Pipe> make_pipe() {
  std::array<int, 2> ends{-1, -1};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return system_error("cannot make a pipe", errno);
  return Pipe{Descriptor(ends[0]), Descriptor(ends[1])};
}

Result<std::string> read_to_end(const Descriptor& source, const Wait& wait, std::size_t most) {
  std::string all;
  std::array<char, 65536> part{};
  for (;;) {
    if (wait.is_stopped()) return no_longer_wanted();
    const TimePoint now = monotonic_now();
    if (now >= wait.deadline) return fail(ErrorCode::DeadlineExceeded, "its output has not ended in time");
    if (!wait_for_input(source.get(), std::min(kReadPeriod, wait.deadline - now))) continue;
    const ssize_t count = ::read(source.get(), part.data(), part.size());
    if (count == 0) return all;
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return system_error("cannot read a pipe", errno);
    if (static_cast<std::size_t>(count) > most - all.size())
      return fail(ErrorCode::ResourceExhausted,
                  "its output has more than " + std::to_string(most) + " bytes");
    all.append(part.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace segue
