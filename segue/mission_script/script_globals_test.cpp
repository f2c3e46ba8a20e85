// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_script/test_support.hpp>

namespace segue::mission {
namespace {

TEST_F(Scripts, RunSideBySide) {
  const auto meet = [](const std::string& mine, const std::string& other) {
    return execute("gvm.set_variable('" + mine + "', True)\nwhile not gvm.get_variable('" + other +
                   "', default=False):\n  if self.preemptive_wait(0.001): break\nreturn 0");
  };
  const auto& result = run(side_by_side(action("left", meet("l", "r")) + action("right", meet("r", "l"))));
  EXPECT_EQ(result.outcome, 0) << result.error;
}

TEST_F(Scripts, OfDecidersKnowHowTheOthersEnded) {
  const auto& result =
      run(side_by_side(action("left", execute("return 'odd'"), "outcomes: [success, odd]") +
                           action("right", execute("raise RuntimeError('right fails')")),
                       "left = self.get_outcome_for_state_name('Left hand')\n"
                       "assert (left.name, left.outcome_id) == ('odd', 1)\n"
                       "assert self.get_outcome_for_state_name('left').name == 'odd'\n"
                       "assert self.get_outcome_for_state_id('right').outcome_id == -1\n"
                       "assert self.get_outcome_for_state_id('nobody') is None\n"
                       "assert 'right fails' in str(self.get_errors_for_state_name('right'))\n"
                       "assert 'right fails' in str(self.get_errors_for_state_id('right'))\n"
                       "assert self.get_errors_for_state_name('Left hand') is None\nreturn 0"));
  EXPECT_EQ(result.outcome, 0) << result.error;
}

// gvm

TEST_F(Scripts, UseGlobalVariables) {
  run_body(
      "gvm.set_variable('a', {'x': [1, 2.5]})\nassert gvm.get_variable('a') == {'x': [1, 2.5]}\n"
      "assert gvm.get_variable('none') is None and gvm.get_variable('none', default=3) == 3\n"
      "gvm.set_variable('a', 'another type')\ngvm.set_variable('i', 1, data_type=int)\n"
      "for wrong in ('text', float('nan'), object()):\n"
      "  try: gvm.set_variable('i', wrong)\n  except (TypeError, ValueError): pass\n"
      "  else: raise AssertionError(wrong)\n"
      "try: gvm.set_variable('j', 'text', data_type=int)\nexcept TypeError: pass\nelse: assert False\n"
      "assert gvm.variable_exist('a') and not gvm.variable_exist('j')\n"
      "assert gvm.get_all_keys() == ['a', 'i'] and gvm.get_all_keys_starting_with('i') == ['i']\n"
      "assert gvm.get_all_variables()['i'] == 1\ngvm.delete_variable('a')\n"
      "gvm.set_variable('null', None)\nassert gvm.get_variable('null', default=1) is None\nreturn 0");
  EXPECT_EQ(engine_->result().outcome, 0) << engine_->result().error;
  EXPECT_EQ(engine_->globals().snapshot(), Value::map({{"i", 1}, {"null", Value()}}));
}

/// A script that does the first body, and then one that does the second.
std::string one_after_the_other(const std::string& first, const std::string& second,
                                const std::string& more = "") {
  return "mission: m\n" + more + "actions:\n" + action("first", execute(first + "\nreturn 0")) +
         action("second", execute(second + "\nreturn 0")) +
         "start: first\nstates:\n  first: {on: {success: second}}\n"
         "  second: {on: {success: return success}}\n";
}

TEST_F(Scripts, PassLiveObjectsByReferenceToEachOther) {
  const auto& result = run(one_after_the_other(
      "import threading\nclass Node: pass\nnode = Node()\nnode.lock = threading.Lock()\nnode.topic = 'scan'\n"
      "gvm.set_variable('node', node, per_reference=True)",
      "gvm.set_variable('topic', gvm.get_variable('node', per_reference=True).topic)\n"
      "assert gvm.get_variable('node') is gvm.get_all_variables()['node']\n"
      "assert gvm.variable_can_be_referenced('node') and not gvm.variable_can_be_referenced('topic')\n"
      "try: gvm.get_variable('node', per_reference=False)\n"
      "except TypeError as error: assert 'Node cannot be copied' in str(error), error\n"
      "else: assert False"));
  EXPECT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(engine_->globals().snapshot(),
            Value::map({{"node", "an object of type Node"}, {"topic", "scan"}}));
}

TEST_F(Scripts, ChangeAListThatAVariableHoldsByReference) {
  const auto& result = run(one_after_the_other(
      "l = [1]\ngvm.set_variable('l', l, per_reference=True)\nl.append(2)",
      "gvm.get_variable('l', per_reference=True).append(3)\ngvm.get_variable('l').append(4)\n"
      "gvm.get_variable('l', per_reference=False).append('in a copy')"));
  EXPECT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(engine_->globals().get("l"), Value::list({1, 2, 3, 4}));
}

TEST_F(Scripts, GetCopiesOfWhatWasSetByValue) {
  const auto& result = run(one_after_the_other(
      "l = [1]\ngvm.set_variable('l', l)\nl.append(2)\nt = ({1: 2}, float('inf'), {3})\n"
      "gvm.set_variable('t', t)\nt[0][1] = 'changed'",
      "assert gvm.get_variable('l') == [1], gvm.get_variable('l')\n"
      "assert gvm.get_variable('t') == ({1: 2}, float('inf'), {3}), gvm.get_variable('t')\n"
      "assert gvm.get_variable('t') is not gvm.get_variable('t')\n"
      "for key in ('l', 't'):\n  try: gvm.get_variable(key, per_reference=True)\n"
      "  except RuntimeError as error: assert 'not set by reference' in str(error)\n  else: assert False"));
  EXPECT_EQ(result.outcome, 0) << result.error;
}

TEST_F(Scripts, PutNoObjectOfAnotherTypeIntoAVariable) {
  const auto& result = run_body(
      "gvm.set_variable('i', 1, data_type=int)\n"
      "for wrong in (object(), [1], (1,)):\n"
      "  try: gvm.set_variable('i', wrong, per_reference=True)\n"
      "  except TypeError as error: assert 'is of type int' in str(error), error\n"
      "  else: raise AssertionError(wrong)\n"
      "gvm.set_variable('l', [1], per_reference=True, data_type=list)\nreturn 0");
  EXPECT_EQ(result.outcome, 0) << result.error;
}

TEST_F(Scripts, LoseNoObjectThatAVariableHoldsAndKeepNoOther) {
  const auto& result = run_body(
      "import gc, weakref\nclass Thing: pass\nseen = []\n"
      "for i in range(5):\n  thing = Thing()\n  seen.append(weakref.ref(thing))\n"
      "  gvm.set_variable('thing', thing, per_reference=True)\n  del thing\n"
      "  assert gvm.get_variable('thing') is seen[-1]()\ngc.collect()\n"
      "gvm.get_all_keys()\nassert [each() is None for each in seen] == [True] * 4 + [False], seen\nreturn 0");
  EXPECT_EQ(result.outcome, 0) << result.error;
}

TEST_F(Scripts, AreToldWhereAnObjectHasGoneWithItsProcess) {
  const auto& result =
      run("mission: m\nactions:\n" +
          action("first", execute("gvm.set_variable('l', [1], per_reference=True)\nreturn 0")) +
          action("dies", execute("import os; os._exit(3)")) +
          action("second", execute("gvm.get_variable('l')\nreturn 0")) +
          "start: first\nstates:\n  first: {on: {success: dies}}\n"
          "  dies: {on: {success: second, aborted: second}}\n"
          "  second: {on: {success: return success}}\n");
  EXPECT_EQ(result.outcome, kAborted);
  EXPECT_THAT(result.error,
              HasSubstr("'l' holds an object of another Python process, or of one that has ended"));
}

TEST_F(Scripts, HaveAnInterpreterOfTheirOwnWhereTheyAreIsolated) {
  const std::string count = execute(
      "import builtins\nbuiltins.count = getattr(builtins, 'count', 0) + 1\noutputs['n'] = builtins.count\n"
      "return 0");
  std::string alone = action("alone", count, "outputs: {n: int}");
  alone.insert(alone.find("        text: |"), "        isolated: true\n");
  const auto& result =
      run("mission: m\noutputs: {shared: int, alone: int}\nactions:\n" +
          action("shared", count, "outputs: {n: int}") + alone +
          "start: a\nflows: [c.n -> outputs.shared, d.n -> outputs.alone]\nstates:\n"
          "  a: {action: shared, on: {success: b}}\n  b: {action: shared, on: {success: c}}\n"
          "  c: {action: shared, on: {success: d}}\n"
          "  d: {action: alone, on: {success: return success}}\n");
  ASSERT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(result.outputs, (std::vector<Value>{3, 1}));
}

TEST_F(Scripts, NameGlobalVariablesByTheTextOfTheirKeys) {
  run_body(
      "gvm.set_variable(5, 1); gvm.set_variable(6, 2)\nassert gvm.get_variable('5') == 1\n"
      "key = gvm.lock_variable(6)\nassert gvm.is_locked('6')\ngvm.unlock_variable(6, key)\n"
      "assert gvm.variable_exist(6)\ngvm.delete_variable(6)\nreturn 0");
  EXPECT_EQ(engine_->result().outcome, 0) << engine_->result().error;
  EXPECT_EQ(engine_->globals().snapshot(), Value::map({{"5", 1}}));
}

TEST_F(Scripts, AbortWhereTheyDeleteAVariableThatDoesNotExist) {
  EXPECT_EQ(error_of("gvm.delete_variable('nope')\nreturn 0"),
            "m:2: AttributeError: there is no global variable 'nope'");
}

TEST_F(Scripts, LockGlobalVariables) {
  run_body(
      "gvm.set_variable('v', 1)\nkey = gvm.lock_variable('v')\nassert key and gvm.is_locked('v')\n"
      "assert gvm.lock_variable('v') is False\n"
      "for access in (None, key + 1):\n"
      "  try: gvm.set_variable('v', 2, access_key=access)\n  except RuntimeError: pass\n"
      "  else: raise AssertionError(access)\n"
      "try: gvm.get_variable('v', access_key=key + 1)\nexcept RuntimeError: pass\nelse: assert False\n"
      "try: gvm.unlock_variable('v', key + 1)\nexcept RuntimeError: pass\nelse: assert False\n"
      "gvm.set_variable('v', 3, access_key=key)\nassert gvm.get_variable('v', access_key=key) == 3\n"
      "gvm.set_locked_variable('v', key, 4)\nassert gvm.get_locked_variable('v', key) == 4\n"
      "assert gvm.unlock_variable('v', key)\nassert not gvm.is_locked('v')\n"
      "key = gvm.lock_variable('v', block=True)\ngvm.unlock_variable('v', None, force=True)\nreturn 0");
  EXPECT_EQ(engine_->result().outcome, 0) << engine_->result().error;
}

TEST_F(Scripts, CountTogetherUnderALock) {
  const std::string count = execute(
      "for i in range(50):\n  key = gvm.lock_variable('n', block=True)\n"
      "  n = gvm.get_variable('n', access_key=key)\n  gvm.set_variable('n', n + 1, access_key=key)\n"
      "  gvm.unlock_variable('n', key)\nreturn 0");
  const auto& result = run("globals: {n: {type: int, default: 0}}\n" +
                           side_by_side(action("left", count) + action("right", count)));
  EXPECT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(engine_->globals().get("n"), Value(100));
}

TEST_F(Scripts, ThatWaitForALockArePreempted) {
  const auto& result = run(
      "mission: m\nactions:\n" +
      action("holder", execute("key = gvm.lock_variable('v')\nself.logger.info('holds')\n"
                               "while not gvm.variable_exist('waits'): pass\nreturn 0")) +
      action("waiter", execute("while not gvm.variable_exist('v'): pass\ngvm.set_variable('waits', True)\n"
                               "key = gvm.lock_variable('v', block=True)\n"
                               "if key is not False: gvm.unlock_variable('v', key)\nreturn 0")) +
      "kind: preemptive\nstates:\n  holder: {on: {success: return success}}\n"
      "  waiter: {on: {success: return success}}\n");
  EXPECT_EQ(result.outcome, 0) << result.error;
}

TEST_F(Scripts, CannotUseGlobalVariablesOnceTheyHaveEnded) {
  const auto& result = run(
      "mission: m\nactions:\n" +
      action(
          "a",
          execute("import threading, builtins\n"
                  "def later():\n  builtins.ended.wait(600)\n"
                  "  try: gvm.get_variable('v')\n"
                  "  except RuntimeError as error: print('refused:', error)\n"
                  "builtins.ended = threading.Event()\nthreading.Thread(target=later).start()\nreturn 0")) +
      action("b", execute("import builtins\nbuiltins.ended.set()\nreturn 0")) +
      "start: a\nstates:\n  a: {on: {success: b}}\n  b: {on: {success: return success}}\n");
  EXPECT_EQ(result.outcome, 0) << result.error;
  EXPECT_TRUE(lines_.wait_for("refused: global variables cannot be used after the end of execute()"));
}

// The process

}  // namespace
}  // namespace segue::mission
