// SPDX-License-Identifier: Apache-2.0
//
// Reading objects from CDR, as if a hostile computer had sent it. The first byte chooses the type.
#include "allocated.hpp"
#include "require.hpp"

#include <segue/type/cdr_flat.hpp>
#include <segue/type/cdr_object.hpp>
#include <segue/type/describe.hpp>
#include <segue/type/flat.hpp>
#include <segue/type/made_type.hpp>
#include <segue/type/memory_layout.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace fuzzed {
enum class Mode : std::int16_t { Back = -1, Idle, Drive = 5 };
struct Sample {
  double value = 0;
  bool valid = false;
  Mode mode = Mode::Idle;
};
struct Point {
  std::int32_t id = 0;
  std::int32_t kind = 0;
  double x = 0;
};
struct Empty {};
struct Tree {
  std::int32_t value = 0;
  std::vector<Tree> branches;
};
struct All {
  std::uint8_t odd = 0;
  std::string name;
  std::vector<Sample> samples;
  std::vector<Point> points;
  std::optional<std::string> remark;
  std::vector<bool> bits;
  std::array<std::vector<std::uint16_t>, 2> two;
  std::vector<Empty> empty;
  std::optional<Sample> last;
  std::vector<std::vector<std::string>> texts;
};

struct Mixed {
  std::uint8_t odd = 0;
  std::string name;
  std::vector<Sample> samples;
  std::vector<bool> bits;
  std::array<std::vector<std::uint16_t>, 2> two;
  std::vector<std::vector<std::string>> texts;
};

SEGUE_TYPE(Mode, Back, Idle, Drive)
SEGUE_TYPE(Sample, value, valid, mode)
SEGUE_TYPE(Point, id, kind, x)
SEGUE_TYPE(Empty)
SEGUE_TYPE(Tree, value, branches)
SEGUE_TYPE(All, odd, name, samples, points, remark, bits, two, empty, last, texts)
SEGUE_TYPE(Mixed, odd, name, samples, bits, two, texts)

}  // namespace fuzzed

namespace segue::type {
namespace {

using fuzz::require;
using testing::allocated;

/// A text or an optional that holds nothing takes four bytes in CDR.
constexpr std::size_t kMostGrowth = (sizeof(std::string) + 3) / 4;
/// A vector that grows at least doubles, and what it holds moves.
constexpr std::size_t kReallocation = 2;

/// To the flat layout and back, as by way of the object, if there is one.
void convert(const TypeInfo& info, std::span<const std::byte> bytes, const void* object, void* other) {
  std::vector<std::byte> flat(flat_size_of_cdr(info, bytes));
  const bool done = !flat.empty() && cdr_to_flat(info, bytes, flat);
  require(done == (object != nullptr), "the flat layout accepts what objects accept");
  if (!done) return;
  require(flat.size() == flat_size(info, object) && is_flat(info, flat), "it is the flat layout");
  require(read_flat(info, other, flat), "and can be read");
  require(info.to_value(other) == info.to_value(object), "and is the same");
  std::vector<std::byte> cdr(cdr_size_of_flat(info, flat));
  std::vector<std::byte> expected(cdr_size(info, object));
  require(flat_to_cdr(info, flat, cdr) && write_cdr(info, object, expected), "and can be written");
  require(cdr == expected, "to the same message");
}

template <class T>
void read(std::span<const std::byte> bytes) {
  static const TypeInfo& info = type_info<T>();
  static T used{};  // what inputs before this one left there
  T object{};
  allocated = 0;
  const bool done = read_cdr(info, &object, bytes);
  require(allocated <= kMostGrowth * kReallocation * bytes.size(), "no more memory than the input justifies");
  require(read_cdr(info, &used, bytes) == done, "what was there before does not matter");
  std::vector<std::byte> again(cdr_size(info, &object));
  require(write_cdr(info, &object, again) == again.size(), "whatever was read can be written");
  T copy{};
  require(read_cdr(info, &copy, again), "and read again");
  require(info.to_value(&copy) == info.to_value(&object), "and is the same");
  convert(info, bytes, done ? &object : nullptr, &copy);
  if (!done) return;
  require(info.to_value(&used) == info.to_value(&object), "an object that was used reads the same");
}

/// A type with the members of Mixed that is made at run time.
const TypeInfo& made_mixed() {
  static const TypeInfo& info = [&]() -> const TypeInfo& {
    std::vector<std::pair<std::string, const Type*>> members;
    for (const Field& field : type_info<fuzzed::Mixed>().type->fields)
      members.emplace_back(field.name, field.type);
    static const Type kType = *make_compound("/fuzzed/MadeMixed", std::move(members));
    return **make_type_info(kType);
  }();
  return info;
}

/// A made type reads what the described type of the same members reads.
void read_made(std::span<const std::byte> bytes) {
  const TypeInfo& made = made_mixed();
  alignas(std::max_align_t) std::array<std::byte, sizeof(fuzzed::Mixed)> memory{};
  fuzzed::Mixed object;
  made.construct(memory.data());
  const bool done = read_cdr(type_info<fuzzed::Mixed>(), &object, bytes);
  require(read_cdr(made, memory.data(), bytes) == done, "made and described types accept the same");
  require(made.to_value(memory.data()) == type_info<fuzzed::Mixed>().to_value(&object), "and read the same");
  convert(made, bytes, done ? memory.data() : nullptr, &object);
  made.destroy(memory.data());
}

}  // namespace
}  // namespace segue::type

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::span bytes = std::as_bytes(std::span(data + 1, size - 1));
  using segue::type::read;
  switch (data[0] % 6) {
    case 0:
      read<fuzzed::Tree>(bytes);
      break;
    case 1:
      read<std::vector<std::optional<fuzzed::Sample>>>(bytes);
      break;
    case 2:
      read<std::vector<std::string>>(bytes);
      break;
    case 3:
      read<std::vector<bool>>(bytes);
      break;
    case 4:
      read<fuzzed::All>(bytes);
      break;
    default:
      read<fuzzed::Mixed>(bytes);
      segue::type::read_made(bytes);
  }
  return 0;
}
