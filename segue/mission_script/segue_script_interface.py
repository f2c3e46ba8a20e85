# SPDX-License-Identifier: Apache-2.0
"""The interface of the Python scripts of missions: `self` and `gvm` of execute(self, inputs, outputs, gvm), and the
conversion of values for the engine. script_worker.py executes the scripts."""
import contextlib
import copy
import itertools
import math
import queue
import re
import threading
import traceback
from collections.abc import Mapping

DEEPEST = 180  # lists and maps within each other; the engine refuses more than 200
SCRIPT_TYPES = {bool: "bool", int: "int", float: "float", str: "text", list: "list", tuple: "list", dict: "map"}


def clean(text):
    """Text that is valid Unicode: lone surrogates become question marks."""
    return str(text).encode("utf-8", "replace").decode("utf-8")


def plain(value, what, depth=0):
    """The value as JSON represents it; otherwise TypeError or ValueError with the place in the value."""
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
    if isinstance(value, BaseException):
        return clean(traceback.format_exception_only(type(value), value)[-1].strip())
    if callable(getattr(value, "tolist", None)):  # arrays and scalars of numpy and the like
        return plain(value.tolist(), what, depth + 1)
    raise TypeError(f"{what}: a value of type {type(value).__name__} cannot be passed on; make it a bool, number, "
                    "text, list or map")


def is_exact(value, around=()):
    """Whether JSON represents the value as it is, with its type: a tuple would become a list."""
    kind = type(value)
    if kind in (list, dict):
        if len(around) > DEEPEST or id(value) in around:
            return False
        around = (*around, id(value))
    if kind is list:
        return all(is_exact(item, around) for item in value)
    if kind is dict:
        return all(type(key) is str and is_exact(key) and is_exact(item, around) for key, item in value.items())
    if value is None or kind in (bool, int, float, str):
        with contextlib.suppress(ValueError):
            plain(value, "")
            return True
    return False


def kind_of(value):
    """The type of a value as missions name it."""
    return next((name for kind, name in SCRIPT_TYPES.items() if isinstance(value, kind)), "any")


def is_small(value, budget=10_000):
    """Whether lists and maps have so few entries that it costs little to copy them."""
    waiting = [value]
    while waiting and budget > 0:
        item = waiting.pop()
        budget -= 1
        if isinstance(item, str):
            budget -= len(item) // 100
        elif callable(getattr(item, "tolist", None)):
            budget -= item.size if isinstance(getattr(item, "size", None), int) else budget
        elif isinstance(item, (list, tuple, Mapping)):
            budget -= len(item)
            if budget > 0:
                waiting.extend(item.values() if isinstance(item, Mapping) else item)
    return budget > 0


def shown(value):
    """What all but scripts see of an object: a copy, where values of missions can represent it and it is small, or a
    text that says what it is."""
    with contextlib.suppress(Exception):
        if is_small(value):
            return plain(value, "")
    return clean(f"an object of type {type(value).__name__}")


class Objects:
    """What global variables hold that is not a value of a mission: objects that were given by reference, and copies of
    those that JSON does not represent. The engine says which ones no variable holds any more."""

    def __init__(self):
        self._lock = threading.Lock()
        self._numbers = itertools.count(1)
        self._kept = {}

    def keep(self, value, by_reference):
        number = next(self._numbers)
        with self._lock:
            self._kept[number] = (value, by_reference)
        return number

    def find(self, numbers):
        """Those of an answer of the engine by the names of the variables, each with its number and whether it was
        given by reference."""
        with self._lock:
            return {name: (number, *self._kept[number]) for name, number in numbers.items() if number in self._kept}

    def forget(self, numbers):
        with self._lock:
            for number in numbers:
                self._kept.pop(number, None)


def key_of(key, what):
    if not isinstance(key, str):
        raise TypeError(f"{what}: the key {key!r} is not a text")
    return plain(key, f"{what}: the key {key!r}")


class Outcome:
    def __init__(self, outcome_id, name):
        self.outcome_id = outcome_id
        self.name = name

    def __str__(self):
        return f"{self.name} ({self.outcome_id})"

    __repr__ = __str__


class ParentState:
    """A state around that of the script."""

    def __init__(self, message, parent, machine):
        self.name = message["name"]
        self.state_id = message["state"]
        self.parent = parent
        self._path = message["path"]
        self._machine = machine

    def get_path(self, by_name=False):
        """By name: the names of the states around it, the outermost first, and its own, as in RAFCON."""
        return path_by_name(self) if by_name else self._path

    def get_state_machine(self):
        return self._machine


def path_by_name(state):
    if isinstance(state.parent, StateMachine):
        return state.name
    return f"{path_by_name(state.parent)}/{state.name}"


class StateMachine:
    """The mission of a script. `root_state` is None where the mission is the script's own state."""

    def __init__(self, message):
        self.name = message["mission"]
        self.file_system_path = message["mission_folder"]
        self.root_state = self.innermost = None
        for parent in message["parents"]:
            self.innermost = ParentState(parent, self.innermost or self, self)
            self.root_state = self.root_state or self.innermost
        self.innermost = self.innermost or self


class Variables(dict):
    """The persistent variables of a state, and the attributes that its scripts have set of `self`."""

    def __init__(self, *values):
        super().__init__(*values)
        self.attributes = {}


class Memory:
    """The persistent variables of a state, as one execution sees them."""

    came_from = None  # the execution whose variables were copied; None: not copied

    def __init__(self, values):
        self._values = values

    def values(self):
        return self._values

    def replace(self, values):
        values = dict(values)
        self.values().clear()
        self.values().update(values)


class MemoryCopy(Memory):
    """Of an execution that may be discarded: a copy, from the first use on. `source`: what is copied, with the number
    of the execution that has left it; None: what counts then."""

    def __init__(self, memories, message, source):
        super().__init__(None)
        self._memories = memories
        self._message = message
        self._source = source
        self._lock = threading.Lock()

    def values(self):
        with self._lock:
            if self._values is None:
                self.came_from, self._values = self._memories.copy(self._message, self._source)
                self._source = None
            return self._values


class Memories:
    """The persistent variables of all states by path, with the number of the execution that has left them (0: none,
    or one that counted at once). Variables of executions that may be discarded are kept aside."""

    def __init__(self):
        self._lock = threading.Lock()
        self._kept = {}
        self._aside = {}
        self._first = None  # the number of the first execution in this process

    def of(self, message):
        self._first = self._first or message["id"]
        if message["discardable"]:
            return MemoryCopy(self, message, self._after(message) if "after" in message else None)
        with self._lock:
            return Memory(self._kept.setdefault(message["path"], (0, Variables()))[1])

    def _after(self, message):
        """What the execution that came before has left, also where it may still be discarded; without values where it
        was, since this one will be, too. Nothing where it left that in a process that has ended. The first one of a run
        has what the last run has left."""
        after = message["after"]
        with self._lock:
            kept = self._kept.get(message["path"], (0, Variables()))
            if after in (0, kept[0]):
                return kept
            if after in self._aside:
                return after, self._aside[after][1]
            return (0, Variables()) if after < self._first else (after, None)

    def copy(self, message, source):
        with self._lock:
            came_from, values = source or self._kept.get(message["path"], (0, Variables()))
        if values is None:
            raise Preempted
        try:
            values = copy.deepcopy(values)
        except Exception as error:
            raise RuntimeError(f"the persistent variables of a pure or sensing script must be copied: {error}") from error
        with self._lock:
            self._aside[message["id"]] = (message["path"], values)
        return came_from, values

    def decide(self, message):
        with self._lock:
            path, values = self._aside.pop(message["id"], (None, None))
            if message["counts"] and path is not None:
                self._kept[path] = (message["id"], values)


class World(frozenset):
    """The facts that hold, as texts: "at(box,table)"; and in `data`, by name, what is attached to them."""

    def __new__(cls, facts, data):
        world = super().__new__(cls, facts)
        world.data = data
        return world

    def __contains__(self, fact):
        """With blanks around commas and brackets or without."""
        return super().__contains__(re.sub(r"\s*([(),])\s*", r"\1", str(fact)))

    def holds(self, fact):
        return fact in self


class DataError(RuntimeError):
    """Data that are attached to the world could not be computed."""


class WorldData(Mapping):
    """What is attached to the world, by name. Data with functions in Python are computed when they are looked at."""

    def __init__(self, known, to_compute, compute):
        self._values = dict(known)
        self._names = [*known, *to_compute]
        self._compute = compute
        self._lock = threading.Lock()

    def __getitem__(self, name):
        if name not in self._names:
            raise KeyError(name)
        with self._lock:
            if name not in self._values:
                self._values[name] = self._compute(name)
            return self._values[name]

    def __iter__(self):
        return iter(self._names)

    def __len__(self):
        return len(self._names)


class Preempted(BaseException):
    """The script was preempted while it used the robot or waited for data of the world. Ends the action as preempted where nobody handles it."""


class RobotError(RuntimeError):
    """What the robot refuses or fails to do. `code`: "not-found", "invalid-argument", "invalid-state" and so on."""

    def __init__(self, text, code):
        super().__init__(text)
        self.code = code


class RobotTimeout(RobotError, TimeoutError):
    """The robot has not answered in time, or no sample or state came."""


class Task:
    """What a task of the robot says of itself."""

    def __init__(self, view):
        self.state = view["state"]
        self.state_name = view["state_name"]
        self.updates = view["updates"]

    def is_in(self, state):
        return state in (self.state_name, self.state)

    def __repr__(self):
        return f"Task(state={self.state!r}, state_name={self.state_name!r}, updates={self.updates})"


class Robot:
    """`self.robot`. Functions block until the robot has answered, and raise RobotError (`self.robot.Error`); any thread
    of the script may call them. Whoever waits when the script is preempted gets Preempted at once; if nobody does, the
    next call raises it. After that a script can look at the robot and release controllers; whatever else it calls raises
    Preempted again."""

    Error = RobotError
    Timeout = RobotTimeout
    Preempted = Preempted

    def __init__(self, channel, message, state):
        self._channel = channel
        self._execution = message["id"]
        self._why_not = message["no_robot"]
        self._state = state
        self._lock = threading.Lock()
        self._waiting = set()
        self._is_told = False  # that it was preempted

    def _interrupt(self):
        with self._lock:
            for answers in self._waiting:
                answers.put(None)
            self._waiting.clear()

    def _tell_once(self):
        """Requires the lock."""
        if self._state.preempted and not self._is_told:
            self._is_told = True
            raise Preempted

    def _ask(self, call, name, **arguments):
        answers = queue.SimpleQueue()
        with self._lock:
            self._tell_once()
            if not self._state.preempted:
                self._waiting.add(answers)
        try:
            answer = self._channel.ask(answers, about="robot", execution=self._execution, call=call, name=name,
                                       **arguments)
        finally:
            with self._lock:
                self._waiting.discard(answers)
        if answer is None:
            self._is_told = True
            raise Preempted
        if "error" not in answer:
            return answer.get("value")
        if answer["code"] == "cancelled":
            raise Preempted
        kind = RobotTimeout if answer["code"] == "deadline-exceeded" else RobotError
        raise kind(f"{call} {name}: {answer['error']}", answer["code"])

    def call(self, operation, arguments=None, timeout=10):
        """Calls "task.operation" with arguments by name; returns its answer."""
        return self._ask("call", text(operation), value=plain(arguments or {}, "arguments"), timeout=seconds(timeout))

    def set(self, name, value, timeout=10):
        """Sets the live property "task.property"."""
        self._ask("set", text(name), value=plain(value, name), timeout=seconds(timeout))

    def write(self, port, value, timeout=10):
        """Writes a sample to the input port "task.port"; returns once the task has read it."""
        self._ask("write", text(port), value=plain(value, port), timeout=seconds(timeout))

    def read(self, port, timeout=10):
        """The latest sample of the output port "task.port" that came since this script has read it last, or else the
        next one."""
        return self._ask("read", text(port), timeout=seconds(timeout))

    def task(self, name):
        """The state of a task that runs: `state`, `state_name` and `updates`."""
        return Task(self._ask("task", text(name)))

    def wait_for_state(self, name, state, timeout=None):
        """Waits until the task has been updated and is in that state; returns the task."""
        longest = {} if timeout is None else {"timeout": seconds(timeout)}
        return Task(self._ask("wait_for_state", text(name), state=text(state), **longest))

    def request(self, controller, set=None, afterwards="keep"):
        """Has the robot run a controller beside what other actions use, until release() or the end of the action;
        returns once it runs. `set`: properties in place of those in its network. `afterwards`: "keep" or "stop"."""
        if afterwards not in ("keep", "stop"):
            raise ValueError(f"'afterwards' is 'keep' or 'stop', not {afterwards!r}")
        self._ask("request", text(controller), set=plain(set or {}, "set"), afterwards=afterwards)

    def release(self, controller):
        """The script uses the controller no more: it runs on until something else is needed, or stops, as the request
        said."""
        self._ask("release", text(controller))


def text(value):
    if not isinstance(value, str):
        raise TypeError(f"expected a text such as 'task.name', not {value!r}")
    return plain(value, "the name")


def seconds(value):
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 <= value < math.inf:
        raise ValueError(f"a timeout is a number of seconds, not {value!r}")
    return float(value)


class ScriptState:
    """`self` in execute(). Attributes that scripts set stay for the next execution of the state, as in RAFCON, where
    the state is the same object."""

    def __init__(self, message, logger, memory, paused):
        self.__dict__["_memory"] = memory  # __setattr__() asks for what is not here
        self.__dict__["_own"] = frozenset()
        self._begin(message, logger, paused)
        self._own = frozenset(self.__dict__) | {"_errors", "_robot", "_compute"}

    def __setattr__(self, name, value):
        if not self._own or name in self._own or hasattr(type(self), name):
            object.__setattr__(self, name, value)
        else:
            self._memory.values().attributes[name] = value

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        attributes = self._memory.values().attributes
        if name not in attributes:
            raise AttributeError(f"scripts have no self.{name}: no execution of this state has set it, and Segue has "
                                 "none (docs: Missions, Python)")
        return attributes[name]

    def __delattr__(self, name):
        if self._memory.values().attributes.pop(name, self) is self:
            raise AttributeError(f"self.{name} cannot be deleted")

    def _begin(self, message, logger, paused):
        self.name = message["name"]
        self.state_id = message["state"]
        self.description = message["description"]
        self.semantic_data = message["notes"]
        self.backward_execution = message["backward"]
        self.input_data = message["inputs"]
        self.output_data = message["outputs"]
        self.run_id = message["run"]
        self._world = message.get("world")
        self._world_data = message.get("world_data")
        self._computed_data = message.get("computed_data")
        self.logger = logger
        self.outcomes = dict(enumerate(map(Outcome, itertools.count(), message["outcomes"])))
        self.outcomes[-1] = Outcome(-1, "aborted")
        self.outcomes[-2] = Outcome(-2, "preempted")
        self._machine = StateMachine(message)
        self.parent = self._machine.innermost
        self._path = message["path"]
        self._preempted = threading.Event()
        self._interrupted = threading.Event()  # paused or preempted
        self._going_on = threading.Event()  # not paused, or preempted
        self._paused = False
        self._set_paused(paused)

    @property
    def persistent_variables(self):
        return self._memory.values()

    @persistent_variables.setter
    def persistent_variables(self, values):
        self._memory.replace(values)

    @property
    def world(self):
        """The facts that hold. In a concurrent run, a pure script gets those that are predicted, and is repeated if they
        were predicted wrongly."""
        if self._world is None:
            raise RuntimeError("the action does not declare 'reads_world'")
        if not isinstance(self._world, World):
            self._world = World(self._world, WorldData(self._world_data, self._computed_data, self._compute))
        return self._world

    @property
    def robot(self):
        if self._robot._why_not:
            raise RuntimeError(self._robot._why_not)
        return self._robot

    @property
    def preempted(self):
        return self._preempted.is_set()

    @property
    def paused(self):
        return self._paused

    @property
    def is_root_state(self):
        return isinstance(self.parent, StateMachine)

    @property
    def started(self):
        return not self._paused

    def preemptive_wait(self, time=None):
        """Waits for that many seconds, or without limit; True if it was preempted meanwhile."""
        return self._preempted.wait(time)

    def wait_for_interruption(self, timeout=None):
        """Waits until it is paused or preempted; False after a timeout."""
        return self._interrupted.wait(timeout)

    def wait_for_unpause(self, timeout=None):
        """Waits until it is resumed or preempted; False after a timeout."""
        return self._going_on.wait(timeout)

    def get_path(self, by_name=False):
        """By name: as of its parents."""
        return path_by_name(self) if by_name else self._path

    def get_state_machine(self):
        return self._machine

    def _preempt(self):
        self._preempted.set()
        self._interrupted.set()
        self._going_on.set()
        self._robot._interrupt()

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
    """`self` of deciders, which also says how its siblings ended."""

    def _begin(self, message, logger, paused):
        super()._begin(message, logger, paused)
        self._branches = message["branches"]

    def _find(self, key, value):
        return next((branch for branch in self._branches if branch[key] == value), None)

    def _outcome(self, branch):
        return branch and Outcome(branch["outcome"], branch["outcome_name"])

    def _error(self, branch):
        return self._errors.find(branch["error"]) if branch and branch["error"] else None

    def get_outcome_for_state_name(self, name):
        return self._outcome(self._find("name", name) or self._find("state", name))

    def get_outcome_for_state_id(self, state_id):
        return self._outcome(self._find("id", state_id) or self._find("state", state_id))

    def get_errors_for_state_name(self, name):
        return self._error(self._find("name", name) or self._find("state", name))

    def get_errors_for_state_id(self, state_id):
        return self._error(self._find("id", state_id) or self._find("state", state_id))


class GlobalVariables:
    """`gvm` in execute(). The variables are kept by the engine. Reading waits while another holder has the lock."""

    LONGEST_PAUSE = 0.05  # seconds between two attempts to get a lock

    def __init__(self, channel, execution, state, objects):
        self._channel = channel
        self._execution = execution
        self._state = state
        self._objects = objects
        self._used = {}  # by variable: the objects that it has used by reference, with their numbers
        self._lock = threading.Lock()

    def _ask(self, call, **arguments):
        return self._answer(call, **arguments).get("value")

    def _answer(self, call, **arguments):
        """With "held" where variables hold objects: as Objects.find() has them."""
        answer = self._channel.ask(execution=self._execution, call=call, **arguments)
        if "error" not in answer:
            return answer
        kinds = {"type-mismatch": TypeError, "not-found": AttributeError}
        raise kinds.get(answer["code"], RuntimeError)(answer["error"])

    def _retry(self, attempt):
        """Repeats the request until it has a result; None if the state was preempted meanwhile."""
        pause = 0.001
        while True:
            result = attempt()
            if result is not None or self._state.preemptive_wait(pause):
                return result
            pause = min(2 * pause, self.LONGEST_PAUSE)

    def _use(self, key, number, value):
        with self._lock:
            self._used[key] = (number, value)

    def _leave(self, key):
        with self._lock:
            self._used.pop(key, None)

    def _shown(self):
        """What the objects show at the end of the execution that it has used by reference."""
        with self._lock:
            return [{"number": number, "value": shown(value)} for number, value in self._used.values()]

    def set_variable(self, key, value, per_reference=False, access_key=None, data_type=None):
        """Keeps a copy of the value, or with `per_reference` the object itself."""
        key = name_of(key)
        if data_type not in (None, type(None)) and value is not None and not isinstance(value, data_type):
            raise TypeError(f"the global variable {key!r} shall be of type {data_type.__name__}, not "
                            f"{type(value).__name__}")
        request = {"name": key, "key": access_key or 0, "type": SCRIPT_TYPES.get(data_type, "any")}
        if is_exact(value) and not (per_reference and isinstance(value, (list, dict))):
            self._ask("set", value=value, **request)
            self._leave(key)
            return
        number = self._objects.keep(value if per_reference else copied(value, key), bool(per_reference))
        self._ask("set", object=number, kind=kind_of(value), value=shown(value), **request)
        self._leave(key)
        if per_reference:
            self._use(key, number, value)

    def get_variable(self, key, per_reference=None, access_key=None, default=None):
        """A copy of the value, or the object itself where the variable was set by reference and `per_reference` is not
        False."""
        key = name_of(key)

        def attempt():
            answer = self._answer("get", name=key, key=access_key or 0)
            return None if answer["value"] is None else answer

        found = self._retry(attempt)
        if found is None:
            raise RuntimeError(f"preempted while the global variable {key!r} was locked")
        if not found["value"]:
            return default
        value = found["value"][0]
        number, held, by_reference = found.get("held", {}).get(key, (None, value, not isinstance(value, (list, dict))))
        if per_reference and not by_reference:
            raise RuntimeError(f"the global variable {key!r} was not set by reference, so it cannot be got so")
        if number is None:
            return value
        if not by_reference or per_reference is False:
            return copied(held, key)
        self._use(key, number, held)
        return held

    def variable_can_be_referenced(self, key):
        """Whether the variable was set by reference."""
        held = self._answer("all").get("held", {}).get(name_of(key))
        return held is not None and held[2]

    def lock_variable(self, key, block=False):
        """An access key; False if another holder has the lock (with `block`: if the state was preempted meanwhile)."""
        key = name_of(key)

        def attempt():
            return self._ask("lock", name=key)

        return (self._retry(attempt) if block else attempt()) or False

    def unlock_variable(self, key, access_key, force=False):
        self._ask("unlock", name=name_of(key), key=access_key or 0, force=bool(force))
        return True

    def set_locked_variable(self, key, access_key, value):
        self.set_variable(key, value, access_key=access_key)

    def get_locked_variable(self, key, access_key, default=None):
        return self.get_variable(key, access_key=access_key, default=default)

    def is_locked(self, key):
        return self._ask("is_locked", name=name_of(key))

    def delete_variable(self, key):
        """AttributeError if there is none."""
        key = name_of(key)
        self._ask("delete", name=key)
        self._leave(key)

    def variable_exist(self, key):
        return name_of(key) in self._ask("all")

    variable_exists = variable_exist

    def get_all_keys(self):
        return list(self._ask("all"))

    def get_all_keys_starting_with(self, start):
        return [key for key in self.get_all_keys() if key.startswith(start)]

    def get_all_variables(self):
        """Copies by name; of variables that were set by reference the objects themselves."""
        answer = self._answer("all")
        values = answer["value"]
        for key, (number, held, by_reference) in answer.get("held", {}).items():
            values[key] = held if by_reference else copied(held, key)
            if by_reference:
                self._use(key, number, held)
        return values

    @property
    def global_variable_dictionary(self):
        return self.get_all_variables()


def name_of(key):
    """Keys of global variables are texts; others become their text, as in RAFCON."""
    return plain(str(key), f"the key {key!r}")


def copied(value, key):
    try:
        return copy.deepcopy(value)
    except Exception as error:
        raise TypeError(f"the global variable {key!r}: an object of type {type(value).__name__} cannot be copied: "
                        f"{error}; set it with per_reference=True") from error
