// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_script/test_support.hpp>

namespace segue::mission {
namespace {

TEST_F(Scripts, ShareAProcessThatEndsWithTheRunner) {
  EXPECT_EQ(run_body("return 0").outcome, 0);
  const auto process = runner_->process();
  ASSERT_TRUE(process);
  EXPECT_EQ(run_body("import atexit\natexit.register(lambda: print('bye'))\nreturn 0").outcome, 0);
  EXPECT_EQ(runner_->process(), process);
  engine_.reset();
  runner_.reset();
  EXPECT_TRUE(is_gone(*process));
  EXPECT_THAT(lines_.text(), HasSubstr("bye"));
}

TEST_F(Scripts, AbortWhereTheirProcessEnds) {
  EXPECT_EQ(error_of("import os\nos._exit(3)"), "the Python process ended with exit status 3");
  EXPECT_EQ(error_of("import os\nos.kill(os.getpid(), 9)\nself.preemptive_wait(600)"),
            "the Python process was killed by signal 9 (Killed)");
  EXPECT_THAT(error_of("import os\nos.write(2, b'out of luck\\n')\nos._exit(0)"),
              "the Python process ended with exit status 0; its last output: out of luck");
  EXPECT_THAT(error_of("import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)\nself.preemptive_wait(600)"),
              HasSubstr("the Python process was killed by signal 11 (Segmentation fault)"));
  EXPECT_EQ(run_body("return 0").outcome, 0);
}

TEST_F(Scripts, AllAbortWhereTheirProcessEnds) {
  load(side_by_side(action("left", execute("gvm.lock_variable('v')\nself.logger.info('left works')\n"
                                           "self.preemptive_wait(600)\nreturn 0")) +
                        action("right", execute("self.logger.info('right works')\nself.preemptive_wait(600)\n"
                                                "return 0")),
                    "for name in ('left', 'right'):\n"
                    "  assert 'killed by signal 9' in str(self.get_errors_for_state_id(name))\n"
                    "assert gvm.lock_variable('v')\nreturn 0"));
  std::thread other([&] {
    EXPECT_TRUE(lines_.wait_for("left works") && lines_.wait_for("right works"));
    ::kill(runner_->process().value(), SIGKILL);
  });
  engine_->run();
  other.join();
  EXPECT_EQ(engine_->result().outcome, 0) << engine_->result().error;
}

TEST_F(Scripts, AbortWhereTheirProcessTalksNonsense) {
  EXPECT_THAT(error_of("import os, time\nos.write(3, b'hello, engine')\nwhile True: time.sleep(1)"),
              StartsWith("the Python process was killed, since it sent an invalid message: a message of "));
  EXPECT_THAT(error_of("import os, time\nos.write(3, b'\\x02\\0\\0\\0{]')\nwhile True: time.sleep(1)"),
              StartsWith("the Python process was killed, since it sent an invalid message: "));
  EXPECT_THAT(error_of("import os, time\nos.write(3, b'\\x02\\0\\0\\0{}')\nwhile True: time.sleep(1)"),
              StartsWith("the Python process was killed, since it sent an unknown message"));
  EXPECT_THAT(
      error_of("import os, time\nos.write(3, b'\\x0c\\0\\0\\0{\"do\":\"end\"}')\nwhile True: time.sleep(1)"),
      HasSubstr("it ended an execution that it had not been given"));
  EXPECT_EQ(run_body("return 0").outcome, 0);
}

TEST_F(Scripts, AbortWhereTheirProcessClosesItsConnection) {
  EXPECT_EQ(error_of("import os, socket\nsocket.socket(fileno=os.dup(3)).shutdown(socket.SHUT_WR)\n"
                     "self.preemptive_wait(600)"),
            "the Python process ended with exit status 0");
}

TEST_F(Scripts, AbortWhereTheirProcessClosesItsConnectionAndGoesOn) {
  write("worker.py", "import os, time\nos.close(3)\ntime.sleep(600)\n");
  options_.worker = folder_ / "worker.py";
  EXPECT_EQ(error_of("return 0"), "the Python process was killed, since it had closed its connection");
}

TEST_F(Scripts, MayForkProcessesThatOnlyCompute) {
  const auto& result = run_body(
      "import os\nreader, writer = os.pipe()\npid = os.fork()\nif pid == 0:\n"
      "  try: gvm.set_variable('v', 1)\n  except RuntimeError: os.write(writer, b'refused')\n  os._exit(0)\n"
      "assert os.read(reader, 100) == b'refused'\nos.waitpid(pid, 0)\nreturn 0");
  EXPECT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(engine_->globals().get("v"), std::nullopt);
}

/// A script that starts a process in a session of its own and stores its pid as 'p'.
std::string starting_session(const std::string& options, const std::string& rest) {
  return "import os, subprocess\nchild = subprocess.Popen(['sleep', '600'], start_new_session=True" +
         options + ")\ngvm.set_variable('p', child.pid)\n" + rest;
}

TEST_F(Scripts, LeaveNoProcessBehind) {
  const std::string plain =
      "import subprocess\ngvm.set_variable('p', subprocess.Popen(['sleep', '600']).pid)\nreturn 0";
  for (const std::string& body :
       {plain, starting_session("", "return 0"), starting_session(", env={}", "return 0"),
        starting_session("", "os._exit(1)"),
        starting_session("", "os.kill(os.getpid(), 9)\nself.preemptive_wait(600)")}) {
    (void)run_body(body);
    const auto child = static_cast<pid_t>(engine_->globals().get("p")->as_int());
    engine_.reset();
    runner_.reset();
    // It is the system's then, which may take a while to look after it.
    EXPECT_TRUE(eventually([&] {
      std::ifstream status("/proc/" + std::to_string(child) + "/stat");
      std::string number, name, state;
      return !(status >> number >> name >> state) || state == "Z";
    })) << body;
    ::kill(child, SIGKILL);
  }
}

TEST_F(Scripts, LeaveNoProcessBehindWhenTheyAreKilled) {
  engine_options_.preemption_grace = 1ms;
  load("mission: m\nactions:\n" +
       action("a", execute(starting_session(", env={}", "self.logger.info('works')\nwhile True: pass"))) +
       "action: a\n");
  std::thread other([&] {
    EXPECT_TRUE(lines_.wait_for("works"));
    engine_->stop();
  });
  engine_->run();
  other.join();
  const auto child = static_cast<pid_t>(engine_->globals().get("p")->as_int());
  engine_.reset();
  runner_.reset();
  EXPECT_TRUE(eventually([&] { return is_gone(child); }));
}

TEST_F(Scripts, AbortWhereTheyCloseTheConnection) {
  for (const std::string body : {"os.close(3)\nreturn 0", "os.closerange(3, 1000)\nreturn 0",
                                 "os.dup2(os.open('/dev/null', os.O_RDWR), 3)\nprint('x')\nreturn 0"})
    EXPECT_THAT(error_of("import os\n" + body), StartsWith("the Python process ")) << body;
  EXPECT_EQ(run_body("return 0").outcome, 0);
}

TEST_F(Scripts, SayWhereThereIsNoInterpreter) {
  for (const std::string python : {"/nowhere/python3", "no_such_python3"}) {
    options_.python = python;
    EXPECT_EQ(refusal(), "cannot find the Python interpreter '" + python +
                             "'; install python3, or name another interpreter");
  }
}

TEST_F(Scripts, SayWhereTheInterpreterIsNone) {
  options_.python = "false";
  EXPECT_EQ(error_of("return 0"), "the Python process ended with exit status 1");
}

TEST_F(Scripts, SayWhereTheWorkerIsNotThere) {
  options_.worker = "/nowhere/worker.py";
  EXPECT_EQ(refusal(), "the script worker '/nowhere/worker.py' is missing");
}

TEST_F(Scripts, MayOutliveTheirEngine) {
  engine_options_.preemption_grace = 1ms;
  load("mission: m\nactions:\n" +
       action("a", execute("self.logger.info('works')\n"
                           "while True: gvm.set_variable('n', 1)")) +
       "action: a\n");
  std::thread other([&] {
    EXPECT_TRUE(lines_.wait_for("works"));
    engine_->stop();
  });
  engine_->run();
  other.join();
  engine_.reset();
  EXPECT_EQ(run_body("return 0").outcome, 0);
}

// Data of the world

}  // namespace
}  // namespace segue::mission
