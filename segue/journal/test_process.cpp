// SPDX-License-Identifier: Apache-2.0
/// Writes entries to the journal named by the first argument until it is killed. After each flush it prints
/// the number of the last safe entry on a line.
#include <segue/journal/journal.hpp>

#include <unistd.h>

#include <iostream>
#include <string>

int main(int argc, char** argv) {
  using namespace segue;
  if (argc != 3) return 2;
  journal::Journal journal(argv[1]);
  for (std::uint64_t request = std::stoull(argv[2]);; ++request) {
    journal::TransitionEntry entry;
    entry.request = request;
    entry.outcome = journal::kDone;
    for (int id = 1; id <= 20; ++id) {
      entry.actions.push_back({id,
                               model::ActionKind::Start,
                               model::Phase::Commit,
                               "start a",
                               "demo::A",
                               model::kLocalHost,
                               {},
                               {},
                               {},
                               std::chrono::microseconds(id),
                               {},
                               journal::kDone,
                               {}});
    }
    journal.add(std::move(entry));
    if (request % 3 != 0) continue;
    if (!journal.flush(RealClock::instance().now() + std::chrono::seconds(60))) return 1;
    std::cout << request << std::endl;
  }
}
