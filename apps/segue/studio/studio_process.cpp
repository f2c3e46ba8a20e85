// SPDX-License-Identifier: Apache-2.0
#include "studio_process.hpp"

#include <segue/base/child_process.hpp>
#include <segue/base/pipe.hpp>

#include <unistd.h>

#include <chrono>
#include <vector>

namespace segue::cli {

Result<StudioProcess> StudioProcess::start(const std::string& robot, std::uint32_t port, bool json) {
  auto input = make_pipe();
  if (!input) return std::move(input.error());
  ChildProcess child(STDERR_FILENO + 1);
  const std::pair<int, int> given[] = {
      {input->read.get(), STDIN_FILENO}, {STDOUT_FILENO, STDOUT_FILENO}, {STDERR_FILENO, STDERR_FILENO}};
  for (const auto& [source, number] : given) {
    if (auto handed = child.hand_over(source, number); !handed) return std::move(handed.error());
  }
  std::vector<std::string> words = {"segue",       "studio", "--robot",           robot,
                                    "--until-eof", "--port", std::to_string(port)};
  if (json) words.insert(words.end(), {"--format", "json"});
  auto pid = child.start("/proc/self/exe", std::move(words), "the studio: ");
  if (!pid) return std::move(pid.error());
  return StudioProcess(*pid, std::move(input->write));
}

StudioProcess::~StudioProcess() {
  if (pid_ == 0) return;
  input_ = Descriptor();
  wait_for_end(pid_, std::chrono::seconds(10));
}

}  // namespace segue::cli
