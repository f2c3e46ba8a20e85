// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>
#include <segue/type/described_type.hpp>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace segue::type {
namespace {

/// Lives as long as the process, since types are used even while it exits.
struct Registry {
  /// Held while types are described, which calls nothing of users.
  Mutex mutex;
  std::map<std::string, const TypeInfo*, std::less<>> by_name SEGUE_GUARDED_BY(mutex);
  detail::DescribedType* announced SEGUE_GUARDED_BY(mutex) = nullptr;
  std::vector<detail::DescribedType*> fresh SEGUE_GUARDED_BY(mutex);  ///< described, but not yet complete
};

Registry& registry() {
  static auto& instance = *new Registry;
  return instance;
}

std::size_t round_up(std::size_t size, std::size_t alignment) {
  return (size + alignment - 1) / alignment * alignment;
}

bool travels_as_bytes(const detail::DescribedType& described);

/// Whether the described members cover the object except for padding: an undescribed member might be a
/// pointer.
bool is_gapless(const detail::DescribedType& described) {
  std::vector<detail::DescribedField> fields = described.shape->fields;
  std::ranges::sort(fields, {}, &detail::DescribedField::offset);
  std::size_t end = 0;
  for (const detail::DescribedField& field : fields) {
    if (field.offset != round_up(end, field.type->info.alignment)) return false;
    if (!travels_as_bytes(*field.type)) return false;
    end = field.offset + field.type->info.size;
  }
  return round_up(end, described.info.alignment) == described.info.size;
}

bool travels_as_bytes(const detail::DescribedType& described) {
  if (!described.info.trivially_copyable) return false;
  switch (described.shape->type.kind) {
    case TypeKind::Numeric:
    case TypeKind::Enum:
      return true;
    case TypeKind::Array:
      return travels_as_bytes(*described.shape->element);
    case TypeKind::Compound:
      return is_gapless(described);
    default:
      return false;
  }
}

void add(Registry& all, const TypeInfo& info) SEGUE_REQUIRES(all.mutex) {
  all.by_name.try_emplace(std::string(info.name()), &info);
}

/// Derives from their shapes what else there is to know of types, and registers them.
void finish(Registry& all, std::span<detail::DescribedType* const> fresh) SEGUE_REQUIRES(all.mutex) {
  for (detail::DescribedType* one : fresh) {
    one->info.trivially_copyable = travels_as_bytes(*one);
    one->info.hash = structural_hash(one->shape->type);
  }
  detail::plan_flat(fresh);
  detail::plan_cdr(fresh);
  for (const detail::DescribedType* one : fresh)
    add(all, one->info);
}

/// Describes the type and its parts.
void complete(Registry& all, detail::DescribedType& described) SEGUE_REQUIRES(all.mutex) {
  detail::part(described);
  finish(all, std::exchange(all.fresh, {}));
}

/// Completes what SEGUE_TYPE announced since the last call.
void complete_announced(Registry& all) SEGUE_REQUIRES(all.mutex) {
  while (all.announced != nullptr) {
    detail::DescribedType* described = std::exchange(all.announced, all.announced->next_announced);
    complete(all, *described);
  }
}

/// "demo::" of "...WrittenName demo::segue_type_name(...)". Anonymous namespaces, for which each compiler has
/// another word, have no name.
std::string scope_of(std::string_view function) {
  std::string scope(function.substr(0, function.find("segue_type_name(")));
  for (const std::string_view anonymous : {"{anonymous}::", "(anonymous namespace)::"}) {
    for (std::size_t at = scope.find(anonymous); at != std::string::npos; at = scope.find(anonymous))
      scope.erase(at, anonymous.size());
  }
  return scope.substr(scope.rfind(' ') + 1);
}

}  // namespace

const TypeInfo* find_type_info(std::string_view name) {
  const Result<std::string> canonical = canonical_type_name(name);
  if (!canonical) return nullptr;
  Registry& all = registry();
  const Lock lock(all.mutex);
  complete_announced(all);
  const auto found = all.by_name.find(*canonical);
  return found == all.by_name.end() ? nullptr : found->second;
}

void register_type_info(const TypeInfo& info) {
  Registry& all = registry();
  const Lock lock(all.mutex);
  add(all, info);
}

namespace detail {

bool announce(DescribedType& described) {
  Registry& all = registry();
  const Lock lock(all.mutex);
  if (!std::exchange(described.announced, true))
    described.next_announced = std::exchange(all.announced, &described);
  return true;
}

/// Unchecked: the caller is within complete(), which holds the registry's mutex.
const Type* part(DescribedType& described) SEGUE_UNCHECKED_LOCKS {
  if (described.shape != nullptr) return &described.shape->type;
  described.shape = new Shape;  // never destroyed: ports keep its address until the process has gone
  Type& type = described.shape->type;
  described.info.type = &type;
  described.info.described = &described;
  described.name(type.name);
  registry().fresh.push_back(&described);
  described.describe(*described.shape);
  return &type;
}

const TypeInfo& complete(DescribedType& described) {
  Registry& all = registry();
  const Lock lock(all.mutex);
  type::complete(all, described);
  return described.info;
}

void complete_made(std::span<DescribedType* const> made) {
  Registry& all = registry();
  const Lock lock(all.mutex);
  finish(all, made);
}

void describe_number(Shape& shape, NumericCategory category, std::size_t size,
                     std::int64_t nanoseconds_per_tick) {
  shape.type.kind = TypeKind::Numeric;
  shape.type.category = category;
  shape.type.size = size;
  shape.type.nanoseconds_per_tick = nanoseconds_per_tick;
}

void describe_enum(Shape& shape, NumericCategory category, std::size_t size) {
  shape.type.kind = TypeKind::Enum;
  shape.type.category = category;
  shape.type.size = size;
}

void describe_compound(Shape& shape, std::size_t size) {
  shape.type.kind = TypeKind::Compound;
  shape.type.size = size;
}

void describe_container(Shape& shape, std::string_view kind, std::size_t size, DescribedType& element) {
  shape.type.kind = TypeKind::Container;
  shape.type.container_kind = kind;
  shape.type.size = size;
  shape.type.element = part(element);
  shape.element = &element;
}

void describe_array(Shape& shape, std::size_t count, DescribedType& element) {
  shape.type.kind = TypeKind::Array;
  shape.type.size = count * element.info.size;
  shape.type.count = count;
  shape.type.element = part(element);
  shape.element = &element;
}

void add_symbol(Shape& shape, std::string_view name, std::int64_t value) {
  shape.type.symbols.push_back({std::string(name), value});
}

void add_field(Shape& shape, std::string_view name, std::size_t offset, DescribedType& type) {
  shape.type.fields.push_back({std::string(name), part(type), offset});
  shape.fields.push_back({std::string(name), offset, &type});
}

void append_type_name(std::string& text, const WrittenName& name) {
  const std::string cpp_name = scope_of(name.function) + std::string(name.type);
  const Result<std::string> canonical = canonical_type_name(cpp_name);
  text += canonical ? *canonical : "/" + cpp_name;
}

std::string number_name(NumericCategory category, std::size_t size) {
  if (category == NumericCategory::Bool) return "/bool";
  if (category == NumericCategory::Float) return size == 4 ? "/float" : "/double";
  return (category == NumericCategory::Unsigned ? "/uint" : "/int") + std::to_string(size * 8) + "_t";
}

void append_duration_name(std::string& text, std::string_view number, std::int64_t numerator,
                          std::int64_t denominator) {
  struct Unit {
    std::int64_t numerator;
    std::int64_t denominator;
    std::string_view name;
  };
  static constexpr std::array<Unit, 6> kUnits = {{{1, 1'000'000'000, "nanoseconds"},
                                                  {1, 1'000'000, "microseconds"},
                                                  {1, 1'000, "milliseconds"},
                                                  {1, 1, "seconds"},
                                                  {60, 1, "minutes"},
                                                  {3600, 1, "hours"}}};
  const auto* unit = std::ranges::find_if(
      kUnits, [&](const Unit& u) { return u.numerator == numerator && u.denominator == denominator; });
  text += "/std/chrono/";
  if (number == "/int64_t" && unit != kUnits.end()) {
    text += unit->name;
    return;
  }
  text += "duration<" + std::string(number) + "," + std::to_string(numerator) + "," +
          std::to_string(denominator) + ">";
}

}  // namespace detail
}  // namespace segue::type
