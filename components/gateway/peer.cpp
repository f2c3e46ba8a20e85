// SPDX-License-Identifier: Apache-2.0
/// The other process of link_test:
///   receive DOMAIN TOPIC TYPE POLICY SIZE   receives until its input ends, and answers the questions there
///   configure DOMAIN INTERFACE              tells how configuring a Receiver ends
#include "test_support.hpp"

#include <atomic>
#include <iostream>
#include <thread>

namespace {

using namespace gateway::testing;  // NOLINT(google-build-using-namespace)

struct Seen {
  std::uint64_t whole = 0;
  std::uint64_t broken = 0;
  std::uint64_t last = 0;
  bool in_order = true;

  void add(std::uint64_t number) {
    ++(number == 0 ? broken : whole);
    in_order = in_order && number > last;
    last = number;
  }
};

std::string to_string(const Seen& seen) {
  return std::to_string(seen.whole) + " whole, " + std::to_string(seen.broken) + " broken, " +
         (seen.in_order ? "in order" : "out of order") + ", last " + std::to_string(seen.last);
}

template <class T>
int receive(Running& receiver) {
  Sink<T> sink(receiver, kPlenty);
  if (!receiver.task().start(soon())) return 1;
  Seen seen;
  for (std::string question; std::getline(std::cin, question);) {
    // Only what counts as received by now has surely arrived at the sink.
    const std::uint64_t count = question == "samples" ? 0 : receiver.count(question);
    for (const std::uint64_t number : sink.read())
      seen.add(number);
    std::cout << (question == "samples" ? to_string(seen) : std::to_string(count)) << std::endl;
  }
  return 0;
}

int receive(const std::vector<std::string>& words) {
  Running receiver("gateway::Receiver");
  const auto& type = words.at(3);
  const auto done = receiver.configure(properties(std::stoi(words.at(1)), words.at(2), type, words.at(4),
                                                  static_cast<std::uint32_t>(std::stoul(words.at(5)))));
  if (!done) {
    std::cerr << segue::to_string(done.error()) << std::endl;
    return 1;
  }
  if (type == name_of<Text>()) return receive<Text>(receiver);
  if (type == name_of<Image>()) return receive<Image>(receiver);
  if (type == name_of<Cloud>()) return receive<Cloud>(receiver);
  return receive<Pose>(receiver);
}

int configure(const std::vector<std::string>& words) {
  Running receiver("gateway::Receiver");
  auto values = properties(std::stoi(words.at(1)), "topic", name_of<Pose>());
  values["interface"] = words.at(2);
  const auto done = receiver.configure(values);
  std::cout << receiver.task().state_name() << "\n"
            << (done ? std::string("done") : segue::to_string(done.error())) << "\nalive" << std::endl;
  return 0;
}

}  // namespace

int main(int count, char** arguments) {
  const std::vector<std::string> words(arguments + 1, arguments + count);
  if (words.empty()) return 2;
  return words.front() == "receive" ? receive(words) : configure(words);
}
