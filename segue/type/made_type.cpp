// SPDX-License-Identifier: Apache-2.0
#include <segue/type/made_type.hpp>

#include <segue/base/mutex.hpp>
#include <segue/base/text.hpp>
#include <segue/type/describe_standard.hpp>
#include <segue/type/described_type.hpp>
#include <segue/type/made_vector.hpp>
#include <segue/type/memory_layout.hpp>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <new>
#include <utility>

namespace segue::type {

namespace {

using detail::DescribedField;
using detail::DescribedType;
using detail::Shape;

std::byte* byte_at(void* object, std::size_t offset) {
  return static_cast<std::byte*>(object) + offset;
}
const std::byte* byte_at(const void* object, std::size_t offset) {
  return static_cast<const std::byte*>(object) + offset;
}

const Shape& shape_of(const TypeInfo& self) {
  return *self.described->shape;
}

struct Compound {
  static void construct(const TypeInfo& self, void* memory) {
    std::memset(memory, 0, self.size);  // the gaps too, since objects may travel as bytes
    for (const DescribedField& field : shape_of(self).fields)
      field.type->info.construct(byte_at(memory, field.offset));
    if (const void* initial = shape_of(self).initial) copy(self, memory, initial);
  }
  static void destroy(const TypeInfo& self, void* object) noexcept {
    for (const DescribedField& field : shape_of(self).fields)
      field.type->info.destroy(byte_at(object, field.offset));
  }
  static void copy(const TypeInfo& self, void* to, const void* from) {
    for (const DescribedField& field : shape_of(self).fields)
      field.type->info.copy(byte_at(to, field.offset), byte_at(from, field.offset));
  }
};

struct Array {
  static void construct(const TypeInfo& self, void* memory) {
    for_each(self,
             [&](const TypeInfo& item, std::size_t offset) { item.construct(byte_at(memory, offset)); });
  }
  static void destroy(const TypeInfo& self, void* object) noexcept {
    for_each(self, [&](const TypeInfo& item, std::size_t offset) { item.destroy(byte_at(object, offset)); });
  }
  static void copy(const TypeInfo& self, void* to, const void* from) {
    for_each(self, [&](const TypeInfo& item, std::size_t offset) {
      item.copy(byte_at(to, offset), byte_at(from, offset));
    });
  }

 private:
  template <class Function>
  static void for_each(const TypeInfo& self, Function function) {
    const TypeInfo& item = shape_of(self).element->info;
    for (std::size_t offset = 0; offset < self.size; offset += item.size)
      function(item, offset);
  }
};

/// Numbers and enums.
struct Plain {
  static void construct(const TypeInfo& self, void* memory) { std::memset(memory, 0, self.size); }
  static void destroy(const TypeInfo& /*self*/, void* /*object*/) noexcept {}
  static void copy(const TypeInfo& self, void* to, const void* from) { std::memcpy(to, from, self.size); }
};

template <class Kind>
constexpr TypeFunctions functions_of() {
  return {&Kind::construct, &Kind::destroy, &Kind::copy, &detail::object_to_value,
          &detail::object_from_value};
}

/// Registers the C++ types of which others are made.
template <class... Types>
void register_types() {
  (type_info<Types>(), ...);
  (type_info<std::vector<Types>>(), ...);
}

void register_own_types() {
  register_types<bool, std::int8_t, std::uint8_t, std::int16_t, std::uint16_t, std::int32_t, std::uint32_t,
                 std::int64_t, std::uint64_t, float, double, std::string>();
}

Error unsupported(const Type& type, const std::string& why) {
  return fail(ErrorCode::Unsupported,
              "objects of type " + quote(type.name) + " cannot be made at run time: " + why);
}

class Maker {
 public:
  explicit Maker(const std::map<std::string, Value>& defaults) : defaults_(defaults) {}

  /// Types that contain themselves never come to an end.
  Result<DescribedType*> make(const Type& type, std::size_t depth = 0) {
    if (type.kind == TypeKind::Alias) return make(type.resolved(), depth);
    if (const TypeInfo* known = find_type_info(type.name)) return use(*known, type);
    if (depth > kDeepestNesting) return unsupported(type, "it contains itself, or too many others");
    switch (type.kind) {
      case TypeKind::Compound:
        return make_compound(type, depth);
      case TypeKind::Array:
        return make_array(type, depth);
      case TypeKind::Container:
        return make_vector(type, depth);
      case TypeKind::Enum:
        return finish(new DescribedType, new Shape{.type = type}, {type.size, type.size},
                      functions_of<Plain>());
      default:
        return unsupported(type, "it is not a struct, number, enum, text, vector or array");
    }
  }

 private:
  /// Never const: constness is what TypeInfo adds for its users.
  static Result<DescribedType*> use(const TypeInfo& known, const Type& type) {
    if (known.described != nullptr && known.hash == structural_hash(type))
      return const_cast<DescribedType*>(known.described);
    return fail(ErrorCode::TypeMismatch, "this process has another type " + quote(type.name) + ":\n" +
                                             definition(*known.type) + "\nnot\n" + definition(type));
  }

  static DescribedType* finish(DescribedType* made, Shape* shape, MemoryLayout layout,
                               const TypeFunctions& functions) {
    made->shape = shape;
    made->info.type = &shape->type;
    made->info.described = made;
    made->info.size = layout.size;
    made->info.alignment = layout.alignment;
    made->info.functions = functions;
    // Preliminary, narrowed when it is completed.
    made->info.trivially_copyable = shape->type.kind != TypeKind::Container &&
                                    (shape->element == nullptr || shape->element->info.trivially_copyable) &&
                                    std::ranges::all_of(shape->fields, [](const DescribedField& field) {
                                      return field.type->info.trivially_copyable;
                                    });
    detail::complete_made(std::span(&made, 1));
    return made;
  }

  Result<DescribedType*> make_compound(const Type& type, std::size_t depth) {
    std::vector<std::pair<std::string, const Type*>> members;
    std::vector<DescribedField> fields;
    for (const Field& field : type.fields) {
      auto part = make(*field.type, depth + 1);
      if (!part) return part;
      members.emplace_back(field.name, &(*part)->shape->type);
      fields.push_back({field.name, field.offset, *part});
    }
    auto placed = type::make_compound(type.name, std::move(members));
    if (!placed) return placed.error();
    for (std::size_t i = 0; i < fields.size(); ++i) {
      if (placed->fields[i].offset != fields[i].offset)
        return unsupported(type,
                           "its member " + quote(fields[i].name) + " does not lie as C++ would place it");
    }
    const auto layout = memory_layout(*placed);
    if (!layout) return layout.error();
    auto* shape = new Shape{.type = std::move(*placed), .fields = std::move(fields)};
    DescribedType* made = finish(new DescribedType, shape, *layout, functions_of<Compound>());
    if (auto done = set_initial(*made); !done) return done.error();
    return made;
  }

  /// An object with the defaults, from which each new one is copied.
  Result<void> set_initial(DescribedType& made) {
    const auto found = defaults_.find(made.shape->type.name);
    if (found == defaults_.end()) return {};
    void* object = ::operator new(made.info.size, std::align_val_t(made.info.alignment));
    made.info.construct(object);
    auto read = made.info.from_value(object, found->second, "default");
    made.shape->initial = read ? object : nullptr;
    return read;
  }

  Result<DescribedType*> make_array(const Type& type, std::size_t depth) {
    const auto item = make(*type.element, depth + 1);
    if (!item) return item;
    const auto layout = memory_layout(type);
    if (!layout) return layout.error();
    auto* shape = new Shape{.type = type, .element = *item};
    shape->type.element = &(*item)->shape->type;
    return finish(new DescribedType, shape, *layout, functions_of<Array>());
  }

  Result<DescribedType*> make_vector(const Type& type, std::size_t depth) {
    if (type.container_kind != "/std/vector") return unsupported(type, "it is not a vector");
    const auto item = make(*type.element, depth + 1);
    if (!item) return item;
    if ((*item)->info.alignment > alignof(std::max_align_t))
      return unsupported(type, "its items need more alignment");
    auto* shape = new Shape{.type = type, .element = *item};
    shape->type.element = &(*item)->shape->type;
    shape->type.size = sizeof(detail::MadeVector);
    auto* made = new DescribedType;
    made->sequence = detail::kMadeVectorAccess;
    return finish(made, shape, {sizeof(detail::MadeVector), alignof(detail::MadeVector)},
                  functions_of<detail::MadeVector>());
  }

  const std::map<std::string, Value>& defaults_;
};

}  // namespace

Result<const TypeInfo*> make_type_info(const Type& type, const std::map<std::string, Value>& defaults) {
  static Mutex one_at_a_time;  // so that no name is made twice
  register_own_types();
  const Lock lock(one_at_a_time);
  const auto made = Maker(defaults).make(type);
  if (!made) return made.error();
  return &(*made)->info;
}

}  // namespace segue::type
