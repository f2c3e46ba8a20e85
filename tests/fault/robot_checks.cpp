// SPDX-License-Identifier: Apache-2.0
#include "robot_checks.hpp"

#include <support/eventually.hpp>

#include <gtest/gtest.h>
#include <signal.h>

#include "processes.hpp"

namespace segue::testing {

namespace {

namespace fs = std::filesystem;

}  // namespace

pid_t pid_of(const fs::path& runtime_folder, const std::string& deployment) {
  const auto all = deployments_of(runtime_folder);
  const auto found = all.find(deployment);
  return found == all.end() ? -1 : found->second;
}

void expect_undisturbed(const std::string& watcher, const std::function<Sight()>& sample) {
  const Sight before = sample();
  Sight now = before;
  EXPECT_TRUE(eventually([&] { return (now = sample()).beats > before.beats + 5; }))
      << watcher << " sees no beats any more";
  EXPECT_EQ(now.gaps, 0U) << watcher;
  EXPECT_EQ(now.restarts, 0U) << watcher;
  EXPECT_EQ(now.torn, 0U) << watcher;
  EXPECT_EQ(now.starts, 1U) << watcher << " itself was started again";
}

void expect_nothing_left(const fs::path& runtime_folder) {
  EXPECT_TRUE(eventually([&] { return processes_of(runtime_folder).empty(); })) << "a process is left";
  for (const auto& [pid, program] : processes_of(runtime_folder)) {
    ADD_FAILURE() << program << ' ' << pid << " is left";
    ::kill(pid, SIGKILL);
  }
  for (const auto& entry : fs::recursive_directory_iterator(runtime_folder)) {
    EXPECT_NE(entry.path().extension(), ".sock") << entry.path() << " is left";
  }
}

}  // namespace segue::testing
