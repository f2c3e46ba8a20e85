// SPDX-License-Identifier: Apache-2.0
//
// Random definitions of messages and random values of them, the same ones for the same seed.

const BASIC = ["bool", "byte", "char", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64", "string"];
const SPECIAL = [0, -0, NaN, Infinity, -Infinity, 1, -1.5, Number.MAX_VALUE, Number.MIN_VALUE, (2 - 2 ** -23) * 2 ** 127, 2 ** -149];
const LETTERS = ["a", "Z", "0", " ", "\n", "\t", '"', "'", "\\", "\u0001", "\u007f", "\u00e4", "\u20ac", "\u{1f916}"];

/** xorshift of 32 bits. */
export class Choice {
  #state;
  /** Whether a text or sequence has been made that is longer than its bound. */
  exceeded = false;

  constructor(seed) {
    this.#state = (seed * 2654435761) >>> 0 || 1;
    for (let i = 0; i < 8; ++i) this.below(2);
  }

  /** An integer from 0 to below `end`, which is at most 2^32. */
  below(end) {
    this.#state ^= this.#state << 13;
    this.#state ^= this.#state >>> 17;
    this.#state ^= this.#state << 5;
    return Math.floor(((this.#state >>> 0) / 2 ** 32) * end);
  }

  of(list) {
    return list[this.below(list.length)];
  }

  /** True once in `rounds`. */
  once(rounds) {
    return this.below(rounds) === 0;
  }

  /** That length, but at most `bound`; seldom one more than that. */
  within(bound, length) {
    if (bound === undefined) return length;
    if (!this.once(60)) return Math.min(length, bound);
    this.exceeded = true;
    return bound + 1;
  }
}

function integer(choice, type) {
  const bits = BigInt(type.match(/\d+$/)[0]);
  const least = type.startsWith("u") ? 0n : -(1n << (bits - 1n));
  const random = (BigInt(choice.below(2 ** 32)) << 32n) | BigInt(choice.below(2 ** 32));
  const offset = choice.of([0n, (1n << bits) - 1n, 1n - least, -least, random % (1n << bits), random % (1n << bits)]);
  const value = least + (offset % (1n << bits));
  return bits === 64n ? value : Number(value);
}

function real(choice, type) {
  const exponent = choice.below(type === "float32" ? 240 : 1900) - (type === "float32" ? 140 : 1000);
  const value = choice.once(3) ? choice.of(SPECIAL) : (choice.below(2 ** 32) / 2 ** 31 - 1) * 2 ** exponent;
  return type === "float32" ? Math.fround(value) : value;
}

function text(choice, bound) {
  const letters = Array.from({ length: choice.below(choice.once(10) ? 300 : 12) }, () => choice.of(LETTERS));
  const bytes = choice.within(bound, Buffer.byteLength(letters.join("")));
  while (Buffer.byteLength(letters.join("")) > bytes) letters.pop();
  return letters.join("") + "+".repeat(bytes - Buffer.byteLength(letters.join("")));
}

function scalar(choice, field) {
  if (field.type === "bool") return choice.once(2);
  if (field.type === "string") return text(choice, field.upperBound);
  return field.type.startsWith("float") ? real(choice, field.type) : integer(choice, field.type);
}

function howMany(choice, field, depth) {
  if (field.arrayLength !== undefined) return field.arrayLength;
  const long = depth === 0 && !field.isComplex && choice.once(6);
  return choice.within(field.arrayUpperBound, choice.once(4) ? 0 : choice.below(long ? 2000 : depth < 3 ? 5 : 2));
}

/** A value of a message: of each of its fields. `fieldsOf`: the fields of a message by its name. */
export function randomValue(choice, fields, fieldsOf, depth = 0) {
  const item = (field) => (field.isComplex ? randomValue(choice, fieldsOf(field.type), fieldsOf, depth + 1) : scalar(choice, field));
  const value = (field) => (field.isArray ? Array.from({ length: howMany(choice, field, depth) }, () => item(field)) : item(field));
  return Object.fromEntries(fields.map((field) => [field.name, value(field)]));
}

const STANDARD = ["builtin_interfaces/Time", "geometry_msgs/Pose", "std_msgs/Header", "std_msgs/Empty", "unique_identifier_msgs/UUID"];

function randomField(choice, earlier, index) {
  let type = choice.once(3) ? choice.of([...STANDARD, ...earlier, ...earlier]) : choice.of(BASIC);
  if (type === "string" && choice.once(3)) type += `<=${1 + choice.below(20)}`;
  const array = choice.of(["", "", "", "[]", `[${1 + choice.below(5)}]`, `[<=${1 + choice.below(5)}]`]);
  return `${type}${array} field${index}`;
}

/** Definitions of messages, some without fields; each may have earlier ones as its parts, as long as that stays small. */
export function randomMessages(choice, count) {
  const all = [];
  const sizes = new Map();
  const sizeOf = (line) => {
    const [, type, length] = line.match(/^(\S+?)(?:\[(?:<=)?(\d*)\])? /);
    return (sizes.get(type) ?? 1) * Number(length || 2);
  };
  for (let number = 0; number < count; ++number) {
    const small = [...sizes].filter(([, size]) => size < 30).map(([type]) => type);
    const lines = Array.from({ length: choice.below(9) }, (_, index) => randomField(choice, small, index));
    const name = `Random${number}`;
    sizes.set(`random_msgs/${name}`, lines.reduce((sum, line) => sum + sizeOf(line), 1));
    all.push({ package: "random_msgs", kind: "msg", name, text: lines.join("\n") });
  }
  return all;
}
