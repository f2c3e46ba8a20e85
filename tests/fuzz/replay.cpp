// SPDX-License-Identifier: Apache-2.0
//
// Gives a fuzzer its inputs without libFuzzer, as a test that every compiler can build: the files that are
// named, those in folders that are named, and simple changes of each, the same ones every time. Where one
// fails, says which, and keeps it.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <numeric>
#include <random>
#include <string>
#include <string_view>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" __attribute__((weak)) int LLVMFuzzerInitialize(int* count, char*** arguments);

// What sanitizers find ends the program by the signal that is handled here.
extern "C" const char* __asan_default_options() {
  return "abort_on_error=1";
}
extern "C" const char* __ubsan_default_options() {
  return "abort_on_error=1:print_stacktrace=1";
}

namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

/// Of a longer input so many places are changed, which are drawn.
constexpr std::size_t kMostPlaces = 200;
constexpr unsigned kSecondsForOne = 60;

/// The input that is tried, for when it fails.
struct Tried {
  std::string name;
  const char* change = "";
  std::size_t place = 0;
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;
  std::string kept_in;
};
Tried tried;

void say(std::string_view text) {
  if (::write(STDERR_FILENO, text.data(), text.size()) < 0) ::_exit(1);
}

void say(std::size_t number) {
  std::array<char, 20> digits{};
  auto first = digits.end();
  do {
    *--first = static_cast<char>('0' + number % 10);
    number /= 10;
  } while (number > 0);
  say({first, static_cast<std::size_t>(digits.end() - first)});
}

/// Calls only what a signal handler may call.
void tell_what_failed(int signal) {
  say("\nThis input failed: ");
  say(tried.name);
  if (*tried.change != 0) {
    say(tried.change);
    say(tried.place);
  }
  const int file = ::open(tried.kept_in.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file >= 0 && ::write(file, tried.data, tried.size) == static_cast<ssize_t>(tried.size)) {
    say("\nIt is kept: `tests/fuzz/make_corpus --describe ");
    say(tried.kept_in);
    say("` makes a seed of it.\n");
  }
  ::raise(signal);  // which is not handled any more
}

void handle_signals() {
  static std::array<std::byte, 65536> stack;  // the usual one may be used up
  stack_t other{};
  other.ss_sp = stack.data();
  other.ss_size = stack.size();
  ::sigaltstack(&other, nullptr);
  for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGALRM}) {
    struct sigaction present {};
    ::sigaction(signal, nullptr, &present);
    if (present.sa_handler != SIG_DFL) continue;  // a sanitizer's, which tells more and aborts
    struct sigaction ours {};
    ours.sa_handler = &tell_what_failed;
    ours.sa_flags = SA_ONSTACK | static_cast<int>(SA_RESETHAND | SA_NODEFER);
    ::sigaction(signal, &ours, nullptr);
  }
}

void try_one(const Bytes& input, const char* change, std::size_t place) {
  // Of its own and no larger, so that a sanitizer sees every read beyond it.
  const std::unique_ptr<std::uint8_t[]> exact(new std::uint8_t[input.size()]);
  std::ranges::copy(input, exact.get());
  tried.change = change;
  tried.place = place;
  tried.data = exact.get();
  tried.size = input.size();
  ::alarm(kSecondsForOne);
  LLVMFuzzerTestOneInput(exact.get(), input.size());
  ::alarm(0);
}

std::vector<std::size_t> places_in(const Bytes& input, std::mt19937& random) {
  std::vector<std::size_t> all(input.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  std::vector<std::size_t> places;
  std::ranges::sample(all, std::back_inserter(places), static_cast<std::ptrdiff_t>(kMostPlaces), random);
  return places;
}

/// Returns how many inputs were tried.
std::size_t try_changes_of(const Bytes& input, std::mt19937& random) {
  std::size_t count = 0;
  for (const std::size_t place : places_in(input, random)) {
    try_one(Bytes(input.begin(), input.begin() + static_cast<std::ptrdiff_t>(place)), ", cut off at byte ",
            place);
    const auto bit = static_cast<std::uint8_t>(1U << random() % 8);
    for (const auto& [change, value] : {std::pair<const char*, std::uint8_t>(", 0 at byte ", 0),
                                        {", 0xff at byte ", 0xff},
                                        {", another bit at byte ", input[place] ^ bit}}) {
      Bytes changed = input;
      changed[place] = value;
      try_one(changed, change, place);
    }
    count += 4;
  }
  return count;
}

/// The files that are named or lie in folders that are named, in the same order everywhere.
std::vector<fs::path> files_of(const std::vector<std::string>& arguments) {
  std::vector<fs::path> files;
  for (const fs::path argument : arguments) {
    if (!fs::is_directory(argument)) {
      files.push_back(argument);
      continue;
    }
    for (const auto& entry : fs::directory_iterator(argument))
      files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

bool read(const fs::path& file, Bytes& content) {
  std::ifstream stream(file, std::ios::binary);
  content.assign(std::istreambuf_iterator<char>(stream), {});
  return stream.is_open() && !stream.bad();
}

}  // namespace

int main(int argc, char** argv) {
  tried.kept_in = fs::absolute(argv[0]).string() + ".failed";
  handle_signals();
  if (LLVMFuzzerInitialize != nullptr && LLVMFuzzerInitialize(&argc, &argv) != 0) return 1;
  const auto files = files_of({argv + 1, argv + argc});
  std::mt19937 random(1);
  std::size_t changes = 0;
  for (const fs::path& file : files) {
    Bytes input;
    if (!read(file, input)) {
      std::fprintf(stderr, "%s cannot be read\n", file.c_str());
      return 1;
    }
    tried.name = file.string();
    try_one(input, "", 0);
    changes += try_changes_of(input, random);
  }
  if (files.empty()) {
    std::fprintf(stderr, "there are no inputs: name files, or folders that hold some\n");
    return 1;
  }
  std::printf("%zu inputs and %zu changes of them were tried\n", files.size(), changes);
  return 0;
}
