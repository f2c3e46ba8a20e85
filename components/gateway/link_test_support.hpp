// SPDX-License-Identifier: Apache-2.0
#pragma once

//
// Both ends of a link in one process, and in two (peer.cpp), over the loopback device.
#include "message.hpp"
#include "names.hpp"
#include "test_support.hpp"

#include <segue/base/child_process.hpp>
#include <segue/sample_link/shared_test_support.hpp>
#include <segue/type/cdr_object.hpp>

#include <support/paths.hpp>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <ctime>
#include <numeric>

namespace gateway::testing {

using segue::BufferKind;
using segue::TaskState;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::int32_t kDomain = own_domain();

inline std::string fresh_topic() {
  static int number = 0;
  return "test/p" + std::to_string(::getpid()) + "_" + std::to_string(++number);
}

inline std::vector<std::uint64_t> numbers(std::uint64_t first, std::uint64_t last) {
  std::vector<std::uint64_t> all(last - first + 1);
  std::iota(all.begin(), all.end(), first);
  return all;
}

/// Tests are skipped, visibly, where the system forbids sockets.
class GatewayLink : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto joined = participant(local_settings(kDomain));
    if (!joined) GTEST_SKIP() << segue::to_string(joined.error());
  }
  std::string topic = fresh_topic();
};

/// The peer program, with pipes to its input and output.
class Peer {
 public:
  explicit Peer(std::vector<std::string> arguments) {
    int to[2];
    int from[2];
    if (::pipe2(to, O_CLOEXEC) != 0 || ::pipe2(from, O_CLOEXEC) != 0) std::abort();
    segue::ChildProcess child(3);
    EXPECT_TRUE(child.hand_over(to[0], 0));
    EXPECT_TRUE(child.hand_over(from[1], 1));
    EXPECT_TRUE(child.hand_over(2, 2));
    arguments.insert(arguments.begin(), segue::paths::kPeer);
    auto started = child.start(segue::paths::kPeer, arguments);
    EXPECT_TRUE(started) << (started ? "" : segue::to_string(started.error()));
    process_ = started.value_or(-1);
    ::close(to[0]);
    ::close(from[1]);
    input_ = to[1];
    output_ = ::fdopen(from[0], "r");
  }
  ~Peer() {
    ::close(input_);
    if (process_ > 0) ::waitpid(process_, nullptr, 0);
    std::fclose(output_);
  }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  /// The next line of its output.
  std::string line() {
    char text[1000] = {};
    if (std::fgets(text, sizeof text, output_) == nullptr) return {};
    std::string line(text);
    if (!line.empty()) line.pop_back();
    return line;
  }
  std::string ask(const std::string& question) {
    const std::string words = question + "\n";
    if (::write(input_, words.data(), words.size()) < 0) return {};
    return line();
  }
  std::uint64_t count(const std::string& counter) { return std::stoull("0" + ask(counter)); }
  void signal(int number) { ::kill(process_, number); }

 private:
  pid_t process_ = -1;
  int input_ = -1;
  FILE* output_ = nullptr;
};

template <class T>
Peer receiving(const std::string& topic, const std::string& policy = "data", int size = 1) {
  return Peer({"receive", std::to_string(kDomain), topic, name_of<T>(), policy, std::to_string(size)});
}

/// Waits until both halves have found each other, as a robot does: the first samples that are sent before the
/// receiver knows the sender would be lost.
inline bool have_matched(Running& sender, Peer& receiver) {
  return sender.has_matched(1) && eventually([&] { return receiver.count("matched") > 0; });
}

}  // namespace gateway::testing
