// SPDX-License-Identifier: Apache-2.0
#include "init_files.hpp"

/// The files that explain every key; tests/system/init_test.cpp tries each of them.
namespace segue::cli {

const std::string_view kRobotFile =
    R"yaml(# The robot file: `segue check robot.yaml` checks it, `segue run robot.yaml` starts the robot.
#
# A line that begins with '#' and no space is a key that you may set: remove that '#', and the one of lines below it that
# are indented further. It has its default, or an example where there is none. Keys that begin with x- are yours alone.

robot: @ROBOT@                          # its name: `segue --robot NAME`, its socket, logs and journal have it
libraries: [segue_components_demo]      # component libraries; `segue component list` shows their components
controllers: [controllers/*.yaml]       # networks of tasks; hold.yaml explains the keys of all of them
missions: [missions/*.yaml]             # plans; visit.yaml explains their keys

# How it comes to rest: `segue stop`, Ctrl-C, and the end of a mission.
halt:
  controller: hold                      # it is switched to this controller
  at_rest: [{task: drive, state: idle}] # it is at rest once all of these hold; if there are none, once it is switched
  # If it is not at rest by then, the tasks that hold devices are stopped.
  #within: 2s
  # It is also stopped when one of these holds: a task is in a state, a sample fulfils a condition, or an operation
  # answers so. There are none by default.
  #when: [{port: laser.scan, where: "range_min < 0"}]
  #when: [{call: odometry.reset, is: false}]

# The computers on which processes may run, with the addresses of their `segue host`.
hosts:
  onboard: local
  #arm:
  #  address: tcp://192.168.1.10:7447   # local, tcp://ADDRESS:PORT or unix:PATH
  #  credentials: certificates          # the folder of certificates for TCP; by default your own
  #  optional: false                    # true: the robot may be switched while this computer cannot be reached

# Models of components that are not installed here, so that their networks can be checked, and run with stand-ins.
#models: []                             # such as [models/*.yaml]
# Transitions that are written by hand, for `segue switch --transition NAME`. There are none by default.
#transitions: [transitions/*.yaml]
# The controller to run if a fault calls for it (`on_failure: fallback`). There is none by default.
#fallback: hold
# The reaction to faults, unless a task or a deployment has its own `on_failure`.
#policies:
#  on_failure: report                   # report, recover (from the error), restart (in a new process) or fallback
#  restart:
#    max: 3                             # attempts, before only a report is left
#    backoff: 100ms                     # the delay before the first attempt; it doubles with each one
#  watch: 1s                            # how often expected and actual state are compared, besides at every event
# The most that controllers may take that are only prepared (`segue prepare`), all of them together.
#look_ahead:
#  processes: 8
#  memory: 2GB
# Units of which it keeps count from one mission to the next (resources that are `of: robot`), with how many there are at
# first; `segue units` shows them.
#units: {screws: 40, deck_place: {count: 3}}
# The program that `segue mission plan` asks for plans; by default a small planner that is built in.
#planner:
#  command: [my-planner, "{domain}", "{problem}"]  # it prints the plan, or writes it into "{plan}"
#  timeout: 60s                         # how long it may take
#  memory: 4GB                          # of each of its processes; by default there is no limit
# Tasks that run beside every controller, each in a process of its own; missions call their operations.
#pools:
#  planner:
#    component: "demo::RoutePlanner"
#    size: 1                            # how many of them, at most 256; 1..3: more than one while calls wait
#    idle_after: 10s                    # how long an instance beyond the least number stays without work
#    properties: {}                     # this and `activity`, `exclusive` and `on_failure` are as of a task
#    on_failure: restart
#    process: {host: onboard}           # with the keys of a deployment
# The most that instances of all pools beyond their least numbers may take on each computer.
#pool_budget:
#  processes: 256
#  memory: 2GB
)yaml";

const std::string_view kControllerFile = R"yaml(# Nobody commands the drive, so it comes to rest.
#
# This file explains all keys of controllers. Lines that begin with '#' and no space are keys that you may set, see robot.yaml.
network: hold                           # its name, as in `segue switch hold`; by default the file's
# Files of which it has the tasks, deployments and connections too; those here are in place of theirs.
#include: [explore.yaml]
tasks:
  drive:
    component: "demo::Drive"            # `segue component show demo::Drive` lists its ports, properties and operations
    # The state that it is brought to: pre_operational, stopped or running.
    #state: running
    # Values of its properties, of structs also of some fields only. By default those of the component.
    #properties: {}
    # When and in which thread it is updated; by default as its component says. It is one of these:
    #activity: port_driven
    #activity: {periodic: 10ms}
    #activity: {trigger: periodic, period: 10ms}
    #activity: {port_driven: true}     # when a sample arrives at an input that the component names
    #activity: {port_driven: [command]}   # at one of these inputs, whatever the component says
    #activity: {fd_driven: true}       # when a descriptor can be read that the component names when it starts
    # or has all of its keys:
    #activity:
    #  periodic: 10ms
    #  scheduler: fifo                  # normal (default), fifo or round_robin
    #  priority: 50                     # 1 to 99, of fifo and round_robin only
    #  optional: true                   # run as normal if the system does not permit the scheduler; default: an error
    #  cpu: [0]                         # the processors on which the thread may run; default: all
    #  thread: control                  # tasks with the same name here share a thread; default: it has its own
    #  update_deadline: 5s              # an update that takes longer counts as hanging; default: ten periods, at least 5 s
    #  spin: 50us                       # how long to look for work before the thread sleeps; default: not at all
    # Devices that only one configured task may hold at the same time. By default those that its component names.
    #exclusive: [/dev/base]
    # The task of the previous controller whose state it continues, itself if it moves to another process. Default: none.
    #takes_over: drive
    # The reaction to its faults: report, recover, restart or fallback; by default that of its deployment.
    #on_failure: report
  odometry: {component: "demo::Odometry"}
  laser: {component: "demo::LaserScanner"}
connections:
  - drive.velocity -> odometry.velocity # an output port, and an input port that gets what is written to it
  - from: {task: odometry, port: pose}  # in full; odometry.pose is the same
    to: laser.pose
    # data: the newest sample; buffer: all of them, new ones are refused when it is full; circular_buffer: the oldest is
    # dropped then.
    #policy: data
    # How many samples a buffer holds. Data is one.
    #size: 1
    # True: a new reader gets the last sample that was written before. For data only.
    #init: false
    # auto, local (in one process), shm (shared memory) or dds (to other computers).
    #link: auto

# Processes, by name. Tasks that are in none of them run in the process of `segue run`.
#deployments:
#  base:
#    tasks: [drive, odometry]           # or {drive: NAME_IN_THE_PROCESS}
#    process: base                      # its name; by default the key
#    host: onboard                      # a computer of robot.yaml; by default this one
#    scheduler: normal                  # this and the next three as of an activity, for threads that say nothing else
#    priority: 0
#    cpu: [0]
#    optional: false
#    environment: {MODE: test}          # variables beside those of `segue run`
#    libraries: [segue_components_bench] # component libraries that only this process loads, beside the robot's
#    limits:                            # by default those of `segue run`
#      memory: 512MB                    # of its own, without what it shares with others
#      open_files: 1024
#      cpu_time: 60s                    # of all its threads together; then it is ended
#      core: 0                          # the size of a core dump; 0: none
#    on_failure: report                 # the reaction if it ends; for its tasks unless they have their own
#    deployer: segue                    # who starts it; others (Rock's) are read, but not started
)yaml";

const std::string_view kMissionFile =
    R"yaml(# Drives to two places: `segue mission run missions/visit.yaml` while the robot runs, or without it with
# `--simulate --clock virtual`.
#
# This file explains all keys of missions. Lines that begin with '#' and no space are keys that you may set, see robot.yaml.
mission: visit

# An action is something that the mission can do. States, below, say when.
actions:
  drive_to:
    inputs: {place: map}                # NAME: TYPE, or NAME: {type: TYPE, default: VALUE}
    outputs: {pose: map}                # types: any, bool, int, float, text, list, map
    outcomes: [arrived]                 # by default [success]; every action may also be aborted and preempted
    # As far as known; for simulations and concurrent runs, which run ahead first what is likely to count.
    expect: {duration: 4s, outcome: arrived, likelihood: {arrived: 0.9}}
    # For people and tools.
    #description: Drives to a place
    # Facts that must hold when it begins, else it aborts; '!' before those that must not.
    #preconditions: ["!charging(robot)"]
    # Facts that must hold until it ends; only those that are observed (`observe`) can change meanwhile.
    #while: ["!charging(robot)"]
    # Facts that become true (+) or false (-) when it ends as expected; also values of world_data: {NAME: "{place}"}.
    #effects: ["+moved(robot)"]
    # Units of resources: {block: NAME} for its duration, or consume, create, delete, release or exists.
    #resources: [{block: road, count: 1, keep: false, parameters: {}}]
    # True: its result may be thrown away, so it may run ahead of its turn.
    #pure: false
    # True: it observes reality, and may be repeated.
    #sensing: false
    # True: it looks at facts that are not among its preconditions. A list: at these values of world_data.
    #reads_world: false
    # True: in concurrent runs it waits until nothing before it can fail any more.
    #strict: false
    run:                                # how it is carried out: here by a controller of the robot
      controller: go_to
      call: {seeker.set_goal: {goal: "{place}"}} # operations to call once it runs; "{place}" is the input
      # Properties to set before, and samples to write to input ports after the operations. None by default.
      #set: {seeker.speed: 0.6}
      #write: {guard.command: {forward: 0.0, turn: 0.0}}
      until:                            # the first of these ends it, with its outcome
        - {task: seeker, state: arrived, outcome: arrived}
        - {after: 2min, outcome: aborted}
        #- {port: seeker.distance, where: "value < 0.2", outcome: arrived}
        #- {call: odometry.reset, is: false, outcome: aborted}
      outputs: {pose: odometry.pose}    # outputs, from the last sample of a port
      # keep: the controller runs on until another one is needed; stop: it is left at once.
      #afterwards: keep
  # Other ways to carry out an action: a function in C++,
  #count: {run: {callback: count}}
  # a script, from a file or as text (isolated: in a process of its own), which may command controllers if it names them,
  #greet:
  #  controllers: [hold]
  #  run: {python: {text: "def execute(self, inputs, outputs, gvm):\n  return 'success'", isolated: false}}
  #greet: {run: {python: {file: greet.py}}}
  # a simulation, whose n-th run has the n-th outcome, or the error,
  #rest:
  #  outputs: {rested: bool}
  #  run: {simulated: {duration: 1s, outcomes: [success], outputs: {rested: true}, error: ""}}
  # rules by the outcomes of the states of a barrier, for its decider,
  #decide: {run: {decide: [{when: {there: arrived}, outcome: success}, {outcome: success}]}}
  # or an operation of a pool of robot.yaml: its answer, or fields of it, are the outcome and the outputs.
  #plan:
  #  outcomes: [found, no_route]
  #  outputs: {route: list}
  #  run:
  #    pool: planner
  #    call: {plan: {from: {x: 0, y: 0}, to: {x: 1, y: 0}}}
  #    outcome_from: outcome
  #    outputs: {route: points}
  #    timeout: 60s

# The mission is a state that contains others. So are all states with `states`, which may have these keys, too:
outcomes: [done, failed]                # by default [success]
outputs: {pose: map}
start: there                            # the first state, or `return OUTCOME`
flows: [back.pose -> outputs.pose]      # STATE.OUTPUT -> STATE.INPUT; also inputs, outputs and variables of this state
#inputs: {speed: {type: float, default: 0.6}}
#variables: {count: {type: int, default: 0}}
# hierarchy: one state after the other; barrier: all at once, until all have ended; preemptive: until the first has.
#kind: hierarchy
# For people, for scripts (`self.state_id`) and for tools.
#title: Visit
#description: Drives to two places
#id: VISIT
#notes: {}
# True: every action in it waits, in concurrent runs, until nothing before it can fail any more.
#strict: false
# True: a concurrent run executes all of it sequentially, as one action.
#routine: false
states:
  there:
    action: drive_to                    # by default the action of the state's name
    inputs: {place: {x: 1.0, y: 0.5}}   # values for inputs that no flow provides
    on: {arrived: back, aborted: return failed} # OUTCOME: STATE, or `return OUTCOME` to leave the state around it
    # Values in place of what the action leaves unset. None by default.
    #outputs: {pose: {}}
  back: {action: drive_to, inputs: {place: {x: 0.0, y: 0.0}}, on: {arrived: return done, aborted: return failed}}
  # A state machine of its own, from `libraries` or from a mission file beside this one.
  #again: {library: detour, on: {arrived: back}}

# These keys are the mission's alone. The robot comes to rest at its end unless it succeeds (halt), or never (keep).
#at_end: halt
# What facts may consist of, if that is to be checked: predicates and the types of their arguments (object, number, boolean,
# text or one under `types`), objects and their types, and types with the types that they are kinds of.
#types: {table: object}
#objects: {dock: object}
#predicates: {at: [text, object], charging: [text]}
# Facts that hold at the beginning; all others do not.
#world: ["at(robot, dock)"]
# Facts that the robot shows by themselves, once a condition has held (or not) for the time `settle`.
#observe: {"charging(robot)": {task: drive, state: idle, settle: 0s}}
# Values that effects of actions change (only 'initial'), or data that follow facts by the functions of a script.
#world_data: {map: {initial: {}, python: {text: "def move(map, robot):\n  pass"}, effects: {"+moved": move}}}
# Values that scripts share, `$NAME` as a default of ports.
#globals: {home: {type: map, default: {x: 0.0, y: 0.0}}}
# Resources, of which there is one unit unless it says otherwise; class: system, process, module, world or task; commutes:
# whoever takes units first makes no difference; observe: the units are there while a condition holds, as of a fact, or as
# many as a sample says ({port: load.cores, units: free}).
# of: robot: the robot keeps their number from one run to the next (`units` in its file).
#resources: {road: {of: mission, class: system, count: 1, parameters: {}, commutes: false, observe: {task: drive, state: idle}}}
# State machines that states use by name.
#libraries: {detour: {action: drive_to, inputs: {place: {x: 0.5, y: 0.0}}}}
)yaml";

}  // namespace segue::cli
