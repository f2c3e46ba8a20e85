// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/mission_io.hpp>
#include <segue/mission_engine/engine.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <utility>

namespace segue::mission {

/// A mission that runs in a thread of its own.
class RunningMission : public ::testing::Test {
 protected:
  void begin_mission(const std::string& text, const Runners& runners) {
    Diagnostics diagnostics;
    auto mission = read_mission(text, "m.yaml", diagnostics);
    ASSERT_TRUE(mission) << to_string(diagnostics);
    auto program = Program::compile(std::move(*mission));
    ASSERT_TRUE(program) << to_string(program.error());
    auto engine = Engine::create(*program, runners);
    ASSERT_TRUE(engine) << to_string(engine.error());
    engine_ = std::move(*engine);
    is_over_ = false;
    thread_ = std::jthread([this] {
      engine_->run();
      is_over_ = true;
    });
  }
  const MissionResult& ended() {
    thread_.join();
    return engine_->result();
  }

  std::unique_ptr<Engine> engine_;
  std::atomic<bool> is_over_ = false;
  std::jthread thread_;
};

}  // namespace segue::mission
