// SPDX-License-Identifier: Apache-2.0
#include "../test_network.hpp"
#include "proc_files.hpp"
#include "types.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace computer {
namespace {

using namespace std::chrono_literals;
using components_test::TestNetwork;
using segue::type::Value;

constexpr const char* kStat =
    "cpu  100 20 30 800 50 0 7 3 90 1\n"
    "cpu0 50 10 15 400 25 0 4 1 45 1\n"
    "cpu1 50 10 15 400 25 0 3 2 45 0\n"
    "intr 1234 5 6\n"
    "ctxt 99\n";
constexpr const char* kMeminfo =
    "MemTotal:       24058256 kB\n"
    "MemFree:        23000000 kB\n"
    "MemAvailable:   23500000 kB\n";

TEST(ProcFiles, SayHowLongProcessorsWereIdle) {
  const auto ticks = processor_ticks(kStat);
  ASSERT_TRUE(ticks);
  EXPECT_EQ(ticks->idle, 850U) << "waiting for a disk included";
  EXPECT_EQ(ticks->all, 1010U) << "guests are in the first two";
  EXPECT_EQ(ticks->processors, 2U);
}

TEST(ProcFiles, OtherTextIsRefused) {
  for (const char* text : {"", "cpu", "cpu  1 2 3\n", "cpu  1 2 3 4 5 6 7 x\n", "intr 1\n",
                           "cpu  1 2 3 4 5 6 7 8\n", "cpu  1 2 3 4 5 6 7 8\ncpu0 1 2 3 4"})
    EXPECT_FALSE(processor_ticks(text)) << text;
  EXPECT_FALSE(memory_bytes("MemTotal: 5 kB\n"));
  EXPECT_FALSE(memory_bytes("MemTotal: x kB\nMemAvailable: 4 kB\n"));
  EXPECT_FALSE(memory_bytes(""));
}

TEST(ProcFiles, SayHowMuchMemoryIsAvailable) {
  const auto memory = memory_bytes(kMeminfo);
  ASSERT_TRUE(memory);
  EXPECT_EQ(memory->total, std::uint64_t{24058256} * 1024);
  EXPECT_EQ(memory->available, std::uint64_t{23500000} * 1024);
}

struct Observer : segue::task::Component {
  segue::task::InputPort<Load> load{*this, "load"};
};

class MonitorTask : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = ::testing::TempDir() + "segue-computer-XXXXXX";
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    write("stat", kStat);
    write("meminfo", kMeminfo);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }

  std::filesystem::path folder_;
};

TEST_F(MonitorTask, TellsHowManyProcessorsWereIdleInTheLastPeriod) {
  Observer observer;
  TestNetwork network;
  network.add("monitor", "computer::Monitor", Value::map({{"folder", folder_.string()}}));
  network.connect(network.output("monitor", "load"), observer.load);
  network.start("monitor");
  // 100 of 400 further ticks were busy, on both processors together.
  write("stat", "cpu  190 20 40 1100 50 0 7 3 90 1\ncpu0 1 2 3 4 5 6 7 8\ncpu1 1 2 3 4 5 6 7 8\nintr 0\n");
  network.advance(500ms);
  Load load;
  ASSERT_EQ(observer.load.read(load), segue::task::ReadStatus::NewData);
  EXPECT_DOUBLE_EQ(load.processors, 2);
  EXPECT_DOUBLE_EQ(load.free_processors, 1.5);
  EXPECT_DOUBLE_EQ(load.memory, 24058256.0 * 1024);
  EXPECT_DOUBLE_EQ(load.free_memory, 23500000.0 * 1024);
}

TEST_F(MonitorTask, FailsWhereTheFilesAreNotWhatLinuxWrites) {
  TestNetwork network;
  auto& task = network.add("monitor", "computer::Monitor", Value::map({{"folder", folder_.string()}}));
  network.start("monitor");
  write("meminfo", "nothing\n");
  network.advance(500ms);
  EXPECT_EQ(task.state(), segue::TaskState::RunTimeError);
}

TEST_F(MonitorTask, WithoutTheFilesItIsNotConfigured) {
  TestNetwork network;
  network.add("monitor", "computer::Monitor", Value::map({{"folder", (folder_ / "none").string()}}));
  EXPECT_THROW(network.start("monitor"), std::runtime_error);
}

TEST(MonitorOfThisComputer, TellsWhatCanBe) {
  Observer observer;
  TestNetwork network;
  network.add("monitor", "computer::Monitor");
  network.connect(network.output("monitor", "load"), observer.load);
  network.start("monitor");
  network.advance(500ms);
  Load load;
  ASSERT_EQ(observer.load.read(load), segue::task::ReadStatus::NewData);
  EXPECT_GE(load.processors, 1);
  EXPECT_GE(load.free_processors, 0);
  EXPECT_LE(load.free_processors, load.processors);
  EXPECT_GT(load.free_memory, 0);
  EXPECT_LE(load.free_memory, load.memory);
}

}  // namespace
}  // namespace computer
