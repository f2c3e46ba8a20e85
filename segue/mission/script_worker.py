# SPDX-License-Identifier: Apache-2.0
"""Executes the Python scripts of missions for the engine that started it (segue/mission/script_runner.hpp).

Messages are JSON with their length in front (4 bytes, little endian), both ways over the socket at descriptor 3. The
main thread reads them; every execution has a thread of its own. The process ends when the socket does. It needs
nothing but Python's own library.
"""
import atexit
import concurrent.futures
import contextlib
import faulthandler
import io
import itertools
import json
import linecache
import logging
import math
import operator
import os
import queue
import socket
import struct
import sys
import threading
import time
import traceback
from collections.abc import Mapping

CHANNEL = 3
DEEPEST = 180  # lists and maps within each other; the engine refuses more than 200
LONGEST_LINE = 4096
LONGEST_ERROR = 4000
SCRIPT_TYPES = {bool: "bool", int: "int", float: "float", str: "text", list: "list", tuple: "list", dict: "map"}


def clean(text):
    """Text that every reader can take: lone surrogates become question marks."""
    return str(text).encode("utf-8", "replace").decode("utf-8")


def plain(value, what, depth=0):
    """The value as JSON carries it, or TypeError or ValueError with the place in it."""
    if depth > DEEPEST:
        raise ValueError(f"{what}: lists and maps are nested deeper than {DEEPEST} levels")
    if value is None or value is True or value is False:
        return value
    if isinstance(value, int):
        if not -(2**63) <= value < 2**64:
            raise ValueError(f"{what}: the number does not fit into 64 bits")
        return int(value)
    if isinstance(value, float):
        if not math.isfinite(value):
            raise ValueError(f"{what}: {float(value)} cannot be passed on; use None")
        return float(value)
    if isinstance(value, str):
        try:
            value.encode("utf-8")
        except UnicodeEncodeError:
            raise ValueError(f"{what}: the text is not valid Unicode") from None
        return str(value)
    if isinstance(value, (list, tuple)):
        return [plain(item, f"{what}[{i}]", depth + 1) for i, item in enumerate(value)]
    if isinstance(value, Mapping):
        return {key_of(key, what): plain(item, f"{what}[{key!r}]", depth + 1) for key, item in value.items()}
    if callable(getattr(value, "tolist", None)):  # arrays and scalars of numpy and the like
        return plain(value.tolist(), what, depth + 1)
    raise TypeError(f"{what}: a value of type {type(value).__name__} cannot be passed on; make it a bool, number, "
                    "text, list or map")


def key_of(key, what):
    if not isinstance(key, str):
        raise TypeError(f"{what}: the key {key!r} is no text")
    return plain(key, f"{what}: the key {key!r}")


class Channel:
    """The engine's end is one reader; messages are sent as a whole."""

    def __init__(self, descriptor, largest):
        os.set_inheritable(descriptor, False)
        self._socket = socket.socket(fileno=descriptor)
        self._reader = self._socket.makefile("rb")
        self._lock = threading.Lock()
        self._numbers = itertools.count(1)
        self._open = {}
        self._forked = False
        self.largest = largest
        os.register_at_fork(after_in_child=self._leave_to_parent)

    def _leave_to_parent(self):
        self._forked = True
        self._lock = threading.Lock()
        os.close(self._socket.detach())

    def send(self, **message):
        data = json.dumps(message, allow_nan=False).encode("ascii")
        if len(data) > self.largest:
            raise ValueError(f"{len(data)} bytes are more than the {self.largest} that can be passed on at once")
        if self._forked:
            raise RuntimeError("this is only possible in the process that executes the script")
        with self._lock:
            self._socket.sendall(struct.pack("<I", len(data)) + data)

    def log(self, level, path, text):
        text = clean(text)
        if len(text) > LONGEST_LINE:
            text = text[:LONGEST_LINE] + "..."
        try:
            self.send(do="log", level=level, path=path, text=text)
        except (OSError, RuntimeError):  # the engine is gone, or this is another process
            with contextlib.suppress(OSError):
                os.write(2, (text + "\n").encode("utf-8"))

    def ask(self, **request):
        """Sends a request, and waits for its answer."""
        number = next(self._numbers)
        answers = self._open[number] = queue.SimpleQueue()
        try:
            self.send(do="ask", number=number, **request)
            return answers.get()
        finally:
            del self._open[number]

    def answer(self, message):
        waiting = self._open.get(message["number"])
        if waiting is not None:
            waiting.put(message)

    def messages(self):
        while True:
            head = self._reader.read(4)
            if len(head) < 4:
                return
            size = struct.unpack("<I", head)[0]
            body = self._reader.read(size)
            if len(body) < size:
                return
            yield json.loads(body)


class Output(io.TextIOBase):
    """sys.stdout and sys.stderr: whole lines, with the state whose script wrote them."""

    encoding = "utf-8"

    def __init__(self, channel, level, raw):
        self._channel = channel
        self._level = level
        self._raw = raw
        self._thread = threading.local()

    @property
    def buffer(self):
        return self._raw.buffer

    def fileno(self):
        return self._raw.fileno()

    def writable(self):
        return True

    def begin(self, path):
        self._thread.path = path

    def write(self, text):
        *lines, rest = (getattr(self._thread, "rest", "") + text).split("\n")
        if len(rest) > LONGEST_LINE:
            lines.append(rest)
            rest = ""
        self._thread.rest = rest
        for line in lines:
            self._channel.log(self._level, getattr(self._thread, "path", ""), line)
        return len(text)

    def end(self):
        if getattr(self._thread, "rest", ""):
            self.write("\n")


class LogHandler(logging.Handler):
    def __init__(self, channel, path=""):
        super().__init__()
        self._channel = channel
        self._path = path
        self.setFormatter(logging.Formatter("%(message)s"))

    def emit(self, record):
        try:
            level = ("error" if record.levelno >= logging.ERROR else "warning" if record.levelno >= logging.WARNING
                     else "info" if record.levelno >= logging.INFO else "debug")
            for line in self.format(record).split("\n"):
                self._channel.log(level, self._path, line)
        except Exception:
            self.handleError(record)


class ScriptLogger(logging.Logger):
    """A logger with RAFCON's level below debug, which counts as debug."""

    def __init__(self, channel, path):
        super().__init__(path, logging.DEBUG)
        self.addHandler(LogHandler(channel, path))

    def verbose(self, message, *arguments, **options):
        self.debug(message, *arguments, **options)


class Outcome:
    def __init__(self, outcome_id, name):
        self.outcome_id = outcome_id
        self.name = name

    def __str__(self):
        return f"{self.name} ({self.outcome_id})"

    __repr__ = __str__


class ScriptState:
    """`self` in execute()."""

    def __init__(self, channel, message, memory, paused):
        self.name = message["name"]
        self.state_id = message["state"]
        self.run_id = message["run"]
        self.persistent_variables = memory
        self.logger = ScriptLogger(channel, message["path"])
        self.outcomes = dict(enumerate(map(Outcome, itertools.count(), message["outcomes"])))
        self.outcomes[-1] = Outcome(-1, "aborted")
        self.outcomes[-2] = Outcome(-2, "preempted")
        self._path = message["path"]
        self._preempted = threading.Event()
        self._interrupted = threading.Event()  # paused or preempted
        self._going_on = threading.Event()  # not paused, or preempted
        self._paused = False
        self._set_paused(paused)

    @property
    def preempted(self):
        return self._preempted.is_set()

    @property
    def paused(self):
        return self._paused

    @property
    def started(self):
        return not self._paused

    def preemptive_wait(self, time=None):
        """Waits for that many seconds or for ever; True when it was preempted meanwhile."""
        return self._preempted.wait(time)

    def wait_for_interruption(self, timeout=None):
        """Waits until it is paused or preempted; False when the time was over first."""
        return self._interrupted.wait(timeout)

    def wait_for_unpause(self, timeout=None):
        """Waits until it is not paused, or preempted; False when the time was over first."""
        return self._going_on.wait(timeout)

    def get_path(self, by_name=False):
        return self._path

    def _preempt(self):
        self._preempted.set()
        self._interrupted.set()
        self._going_on.set()

    def _set_paused(self, paused):
        self._paused = paused
        if paused:
            self._interrupted.set()
        elif not self.preempted:
            self._interrupted.clear()
        if not paused or self.preempted:
            self._going_on.set()
        else:
            self._going_on.clear()


class ScriptDecider(ScriptState):
    """`self` of deciders: how the states beside it ended."""

    def __init__(self, channel, message, memory, paused):
        super().__init__(channel, message, memory, paused)
        self._branches = message["branches"]

    def _find(self, key, value):
        return next((branch for branch in self._branches if branch[key] == value), None)

    def _outcome(self, branch):
        return branch and Outcome(branch["outcome"], branch["outcome_name"])

    def _error(self, branch):
        return RuntimeError(branch["error"]) if branch and branch["error"] else None

    def get_outcome_for_state_name(self, name):
        return self._outcome(self._find("name", name) or self._find("id", name))

    def get_outcome_for_state_id(self, state_id):
        return self._outcome(self._find("id", state_id))

    def get_errors_for_state_name(self, name):
        return self._error(self._find("name", name) or self._find("id", name))

    def get_errors_for_state_id(self, state_id):
        return self._error(self._find("id", state_id))


class GlobalVariables:
    """`gvm` in execute(): the variables live in the engine. Reading waits while somebody else holds the lock."""

    LONGEST_PAUSE = 0.05  # seconds between two looks at a lock

    def __init__(self, channel, execution, state):
        self._channel = channel
        self._execution = execution
        self._state = state

    def _ask(self, call, **arguments):
        answer = self._channel.ask(execution=self._execution, call=call, **arguments)
        if "error" not in answer:
            return answer.get("value")
        raise (TypeError if answer["code"] == "type-mismatch" else RuntimeError)(answer["error"])

    def _retry(self, attempt):
        """Until it gives something; None when the state was preempted meanwhile."""
        pause = 0.001
        while True:
            result = attempt()
            if result is not None or self._state.preemptive_wait(pause):
                return result
            pause = min(2 * pause, self.LONGEST_PAUSE)

    def set_variable(self, key, value, per_reference=False, access_key=None, data_type=None):
        if data_type not in (None, type(None)) and value is not None and not isinstance(value, data_type):
            raise TypeError(f"the global variable {key!r} shall be of type {data_type.__name__}, not "
                            f"{type(value).__name__}")
        self._ask("set", name=key, value=plain(value, key), key=access_key or 0,
                  type=SCRIPT_TYPES.get(data_type, "any"))

    def get_variable(self, key, per_reference=None, access_key=None, default=None):
        found = self._retry(lambda: self._ask("get", name=key, key=access_key or 0))
        if found is None:
            raise RuntimeError(f"preempted while the global variable {key!r} was locked")
        return found[0] if found else default

    def lock_variable(self, key, block=False):
        """An access key; False where somebody else holds the lock (with `block`: and it was preempted meanwhile)."""
        def attempt():
            return self._ask("lock", name=key)

        return (self._retry(attempt) if block else attempt()) or False

    def unlock_variable(self, key, access_key, force=False):
        self._ask("unlock", name=key, key=access_key or 0, force=bool(force))
        return True

    def set_locked_variable(self, key, access_key, value):
        self.set_variable(key, value, access_key=access_key)

    def get_locked_variable(self, key, access_key, default=None):
        return self.get_variable(key, access_key=access_key, default=default)

    def is_locked(self, key):
        return self._ask("is_locked", name=key)

    def delete_variable(self, key):
        self._ask("delete", name=key)

    def variable_exist(self, key):
        return key in self.get_all_variables()

    variable_exists = variable_exist

    def get_all_keys(self):
        return list(self.get_all_variables())

    def get_all_keys_starting_with(self, start):
        return [key for key in self.get_all_keys() if key.startswith(start)]

    def get_all_variables(self):
        return self._ask("all")

    @property
    def global_variable_dictionary(self):
        return self.get_all_variables()


class Scripts:
    """Compiled scripts: text once, files again when they have changed."""

    def __init__(self):
        self._lock = threading.Lock()
        self._compiled = {}

    def module(self, message):
        """The variables of the script's module, which runs anew for every execution."""
        with self._lock:
            code = self._code(message)
        names = {"__name__": "segue_script", "__file__": code.co_filename, "__builtins__": __builtins__}
        exec(code, names)
        return names

    def _code(self, message):
        name = script_name(message)
        if message["folder"] and message["folder"] not in sys.path:
            sys.path.append(message["folder"])
        if "text" in message:
            stamp, source = message["text"], message["text"]
        else:
            status = os.stat(name)
            stamp, source = (status.st_mtime_ns, status.st_size, status.st_ino), None
        known = self._compiled.get(name)
        if known and known[0] == stamp:
            return known[1]
        if source is None:
            with open(name, "rb") as file:
                source = file.read()
            linecache.checkcache(name)
        else:
            linecache.cache[name] = (len(source), None, source.splitlines(True), name)
        code = compile(source, name, "exec", dont_inherit=True)
        self._compiled[name] = (stamp, code)
        return code


def script_name(message):
    return message["file"] if "file" in message else message["path"] or message["name"]


def describe(error, script):
    """"FILE:LINE: ValueError: what", where LINE is the innermost one of the script."""
    lines = traceback.format_exception_only(type(error), error)
    place = script
    if isinstance(error, SyntaxError) and error.filename == script:
        place = f"{script}:{error.lineno}"
        lines = [f"{type(error).__name__}: {error.msg}"]
    for frame, line in traceback.walk_tb(error.__traceback__):
        if frame.f_code.co_filename == script:
            place = f"{script}:{line}"
    return clean(f"{place}: {lines[-1].strip()}")[:LONGEST_ERROR]


def full_traceback(error):
    """Without the frames of this file."""
    trace = error.__traceback__
    while trace is not None and trace.tb_frame.f_code.co_filename == __file__:
        trace = trace.tb_next
    return "".join(traceback.format_exception(type(error), error, trace)).rstrip("\n")


class Worker:
    def __init__(self, channel):
        self._channel = channel
        self._scripts = Scripts()
        self._memories = {}
        self._states = {}
        self._paused = False
        self._lock = threading.Lock()
        self._pool = concurrent.futures.ThreadPoolExecutor(max_workers=1_000_000)
        self._outputs = [Output(channel, "info", sys.__stdout__), Output(channel, "warning", sys.__stderr__)]
        sys.stdout, sys.stderr = self._outputs
        logging.getLogger().addHandler(LogHandler(channel))

    def run(self):
        actions = {"execute": self._execute, "preempt": self._preempt, "pause": self._pause,
                   "answer": self._channel.answer}
        for message in self._channel.messages():
            actions[message["do"]](message)

    def _execute(self, message):
        kind = ScriptDecider if "branches" in message else ScriptState
        memory = self._memories.setdefault(message["path"], {})
        with self._lock:
            state = kind(self._channel, message, memory, self._paused)
            self._states[message["id"]] = state
        try:
            self._pool.submit(self._in_thread, message, state)
        except RuntimeError as error:
            self._end(message["id"], error=f"no thread for the script: {error}")

    def _preempt(self, message):
        state = self._states.get(message["id"])
        if state is not None:
            state._preempt()

    def _pause(self, message):
        with self._lock:
            self._paused = message["paused"]
            for state in self._states.values():
                state._set_paused(self._paused)

    def _in_thread(self, message, state):
        for output in self._outputs:
            output.begin(message["path"])
        try:
            ending = self._call(message, state)
        except BaseException as error:  # SystemExit too: only this execution ends
            for line in full_traceback(error).split("\n"):
                self._channel.log("debug" if state.preempted else "error", message["path"], line)
            ending = {"error": describe(error, script_name(message))}
        for output in self._outputs:
            output.end()
            output.begin("")
        self._end(message["id"], **ending)

    def _call(self, message, state):
        names = self._scripts.module(message)
        name = "backward_execute" if message["backward"] else "execute"
        if name not in names:
            if message["backward"]:
                return {"outcome": 0}
            return {"error": f"{script_name(message)}: it has no execute(self, inputs, outputs, gvm)"}
        outputs = message["outputs"]
        declared = list(outputs)
        gvm = GlobalVariables(self._channel, message["id"], state)
        answer = names[name](state, message["inputs"], outputs, gvm)
        for key in outputs.keys() - set(declared):
            state.logger.warning("outputs[%r] is not one of its outputs; ignored", key)
        ending = {"outcome": 0 if message["backward"] else self._outcome(state, answer),
                  "outputs": {key: plain(outputs.get(key), f"outputs[{key!r}]") for key in declared}}
        if ending["outcome"] is None:
            known = ", ".join(repr(outcome.name) for outcome in state.outcomes.values())
            text = f"{script_name(message)}: execute() returned {clean(repr(answer))[:200]}, which is none of its " \
                   f"outcomes: {known}"
            return {"error": text}
        if ending["outcome"] == -1:
            ending["error"] = f"{script_name(message)}: execute() returned 'aborted'"
        return ending

    @staticmethod
    def _outcome(state, answer):
        """Its number, whether the script gave that or the name; None where it is neither."""
        if not isinstance(answer, str):
            try:
                answer = operator.index(answer)
            except TypeError:
                return None
        for number, outcome in state.outcomes.items():
            if answer in (number, outcome.name):
                return number
        return None

    def _end(self, execution, **ending):
        try:
            self._channel.send(do="end", id=execution, **ending)
        except ValueError as error:  # too large
            self._channel.send(do="end", id=execution, error=f"its outputs: {error}")
        except OSError:
            pass  # the engine is gone
        finally:
            with self._lock:
                self._states.pop(execution, None)


def die_with_parent():
    """Where a script keeps the interpreter to itself, nobody sees that the socket has closed."""
    try:
        import ctypes
        import signal
        ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG
    except (ImportError, OSError, AttributeError):
        pass


def give_up_later():
    time.sleep(1)
    os._exit(0)


def main():
    sys.path[:] = [folder for folder in sys.path if folder != os.path.dirname(__file__)]
    die_with_parent()
    faulthandler.enable()
    Worker(Channel(CHANNEL, int(sys.argv[1]))).run()


if __name__ == "__main__":
    try:
        main()
    except BaseException:
        os.write(2, traceback.format_exc().encode("utf-8", "replace"))
        os._exit(1)
    # Threads of scripts may go on for ever; nothing waits for them.
    threading.Thread(target=give_up_later, daemon=True).start()
    atexit._run_exitfuncs()
    os._exit(0)
