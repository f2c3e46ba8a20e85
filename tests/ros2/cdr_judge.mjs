// SPDX-License-Identifier: Apache-2.0
//
// Compares how Segue encodes messages of ROS 2 as CDR with how the npm packages @foxglove/rosmsg2-serialization and @foxglove/cdr do,
// which read the definitions with @foxglove/rosmsg: all messages of the interfaces that are built in, and random ones, with random
// values. Both must write the same bytes and read them as the same values, to the last bit; Segue reads both byte orders, and knows
// where a value exceeds bounds. Wide strings are not judged, because both refuse them.
//
//   cdr_judge.mjs PACKAGES PIPE INTERFACES [SEEDS [FIRST_SEED]]
//
// PACKAGES     the folder with node_modules
// PIPE         the program cdr_pipe
// INTERFACES   the folder with the interfaces that are built in
// SEEDS        how many seeds; each has other values and other random messages
// Status 1: they differ; the first differences are printed. 77: the packages are not installed.
import childProcess from "node:child_process";
import fs from "node:fs";
import { createRequire } from "node:module";
import os from "node:os";
import path from "node:path";
import process from "node:process";
import util from "node:util";

import { builtInMessages } from "./interface_files.mjs";
import { Choice, randomMessages, randomValue } from "./random_messages.mjs";

const [packages, pipe, interfaces, seeds = "8", firstSeed = "1"] = process.argv.slice(2);
const require = createRequire(path.resolve(packages, "package.json"));

function judge() {
  try {
    return { ...require("@foxglove/rosmsg"), ...require("@foxglove/rosmsg2-serialization"), ...require("@foxglove/cdr") };
  } catch (error) {
    if (error.code !== "MODULE_NOT_FOUND") throw error;
    console.log(`skipped: the packages of tests/ros2/package.json are not installed in ${packages}`);
    process.exit(77);
  }
}

const { parse, MessageReader, MessageWriter, CdrWriter, EncapsulationKind } = judge();

// That of the package takes the number of UTF-16 units for the number of bytes, and cuts texts that are not ASCII.
CdrWriter.prototype.string = function (text) {
  const bytes = Buffer.from(text, "utf8");
  return this.uint32(bytes.length + 1).uint8Array(bytes).uint8(0);
};

/** Messages as the judge reads their texts: by name, such as "geometry_msgs/Point". */
class Definitions {
  #all;

  constructor(messages) {
    const texts = messages.map(({ package: owner, name, text }) => `MSG: ${owner}/${name}\n${text.replace(/(\w+)\/msg\//g, "$1/")}`);
    this.#all = new Map(parse(texts.join("\n===\n"), { ros2: true }).map(({ name, definitions }) => [name, sentFields(definitions)]));
  }

  fieldsOf = (name) => this.#all.get(name);

  /** The package's reader and writer take the first message for the one that is meant. */
  from(name) {
    return [name, ...this.#all.keys()].map((one) => ({ name: one, definitions: this.#all.get(one) }));
  }
}

const BUILT_IN = { time: "builtin_interfaces/Time", duration: "builtin_interfaces/Duration" };

/** A message that would be empty is sent with a field. Times are messages in ROS 2, but not in the packages. */
function sentFields(fields) {
  const sent = fields.filter((field) => !field.isConstant);
  if (sent.length === 0) return [{ name: "structure_needs_at_least_one_member", type: "uint8", isComplex: false, isArray: false }];
  return sent.map((field) => (field.type in BUILT_IN ? { ...field, type: BUILT_IN[field.type], isComplex: true } : field));
}

const bits = (number) => new BigUint64Array(new Float64Array([number]).buffer)[0];

/** A value with its numbers as cdr_pipe.cpp has them. */
function asTexts(definitions, fields, value) {
  const scalar = (field, one) => String(field.type.startsWith("float") ? bits(one) : one);
  const item = (field, one) => (field.isComplex ? asTexts(definitions, definitions.fieldsOf(field.type), one) : scalar(field, one));
  const texts = (field, its) => (field.isArray ? Array.from(its, (one) => item(field, one)) : item(field, its));
  return Object.fromEntries(fields.map((field) => [field.name, texts(field, value[field.name])]));
}

/** The package writes big endian a number at a time only. */
function writeFields(definitions, fields, value, writer) {
  for (const field of fields) {
    const items = field.isArray ? value[field.name] : [value[field.name]];
    if (field.isArray && field.arrayLength === undefined) writer.sequenceLength(items.length);
    for (const item of items) {
      if (field.isComplex) writeFields(definitions, definitions.fieldsOf(field.type), item, writer);
      else writer[field.type === "bool" ? "uint8" : field.type](item);
    }
  }
  return writer;
}

const hex = (bytes) => Buffer.from(bytes).toString("hex");

/** As it comes from a middleware that fills messages up to a multiple of four bytes, and tells by how many in the header. */
function padded(message) {
  const filled = (4 - ((message.length / 2) % 4)) % 4;
  return `0001000${filled}${message.slice(8)}${"00".repeat(filled)}`;
}

/** A message with a random value, as the judge encodes it and as Segue is asked for it. */
function makeCase(choice, definitions, message) {
  const name = `${message.package}/${message.name}`;
  const fields = definitions.fieldsOf(name);
  choice.exceeded = false;
  const value = randomValue(choice, fields, definitions.fieldsOf);
  const little = hex(new MessageWriter(definitions.from(name)).writeMessage(value));
  const big = hex(writeFields(definitions, fields, value, new CdrWriter({ kind: EncapsulationKind.CDR_BE })).data);
  const texts = asTexts(definitions, fields, value);
  const request = { type: `${message.package}/${message.kind}/${message.name}`, value: texts, messages: [little, big, padded(little)] };
  const read = (bytes) => asTexts(definitions, fields, new MessageReader(definitions.from(name)).readMessage(Buffer.from(bytes, "hex")));
  return { message, value, exceeded: choice.exceeded, little, texts: JSON.stringify(texts), request, read };
}

function asPackagesRead({ read }, bytes) {
  try {
    return JSON.stringify(read(bytes));
  } catch (error) {
    return String(error);
  }
}

/** In what Segue's answer differs; nothing where it does not. */
function difference(asked, answer) {
  const { little, texts, exceeded } = asked;
  if (answer.error) return `Segue: ${answer.error}`;
  const theirs = asPackagesRead(asked, answer.written);
  if (theirs !== texts) return `what Segue writes,\n  ${answer.written}\nthe packages read as\n  ${theirs}`;
  if (answer.written !== little) return `Segue writes other bytes:\n  ${answer.written}`;
  for (const [i, { value, relayed, bounds }] of answer.read.entries()) {
    const which = ["little endian", "big endian", "a filled message"][i];
    if (JSON.stringify(value) !== texts) return `Segue reads another value of ${which}:\n  ${JSON.stringify(value)}`;
    if (relayed !== little) return `shared memory makes other bytes of ${which}:\n  ${relayed}`;
    if ((bounds !== "") !== exceeded) return `bounds are ${exceeded ? "" : "not "}exceeded, but Segue says of ${which}: '${bounds}'`;
  }
  return "";
}

function ask(cases, folder) {
  const input = cases.map(({ request }) => JSON.stringify(request) + "\n").join("");
  const done = childProcess.spawnSync(pipe, [folder], { input, maxBuffer: 2 ** 30 });
  if (done.error && done.error.code !== "EPIPE") throw done.error;
  const lines = done.stdout.toString().split("\n").slice(0, -1);
  if (done.status !== 0 || lines.length !== cases.length) {
    const at = cases[lines.length]?.request.type ?? "its end";
    throw new Error(`${pipe} ended with ${done.status ?? done.signal} at ${at}: ${done.stderr}`);
  }
  return lines.map((line) => JSON.parse(line));
}

/** What differs with the random messages and values of a seed, and how much was compared. */
function run(seed) {
  const choice = new Choice(seed);
  const builtIn = builtInMessages(interfaces);
  const random = randomMessages(choice, 150);
  const definitions = new Definitions([...builtIn, ...random]);
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), "cdr_judge_"));
  try {
    fs.mkdirSync(path.join(folder, "random_msgs", "msg"), { recursive: true });
    for (const { name, text } of random) fs.writeFileSync(path.join(folder, "random_msgs", "msg", `${name}.msg`), text);
    const cases = [...builtIn, ...random].map((message) => makeCase(choice, definitions, message));
    const answers = ask(cases, folder);
    const wrong = cases.map((one, i) => ({ ...one, why: difference(one, answers[i]) })).filter(({ why }) => why !== "");
    const bytes = cases.reduce((sum, { little }) => sum + little.length / 2, 0);
    const exceed = cases.filter(({ exceeded }) => exceeded).length;
    const compared = `${builtIn.length} messages of built-in interfaces and ${random.length} random ones, ${bytes} bytes`;
    return { wrong, compared: `${compared}; ${exceed} exceed bounds` };
  } finally {
    fs.rmSync(folder, { recursive: true });
  }
}

function show({ message, value, little, why }, seed) {
  const shown = util.inspect(value, { depth: null, maxArrayLength: 20, maxStringLength: 60 });
  console.log(`${message.package}/${message.name} (seed ${seed}): ${why}\nthe packages write:\n  ${little}\nof\n${shown}\nin\n${message.text}\n`);
}

for (let seed = Number(firstSeed); seed < Number(firstSeed) + Number(seeds); ++seed) {
  const { wrong, compared } = run(seed);
  for (const one of wrong.slice(0, 3)) show(one, seed);
  console.log(`seed ${seed}: ${compared}; ${wrong.length} differ`);
  if (wrong.length > 0) process.exitCode = 1;
}
