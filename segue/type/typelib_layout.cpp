// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/type/typelib_layout.hpp>
#include <segue/type/value.hpp>

#include <algorithm>
#include <utility>

namespace segue::type::detail {
namespace {

/// Bytes, or 0 where they are not known. `sizes` wins; arrays follow their element.
std::size_t size_in_file(const Type& type, const TypeSizes& sizes) {
  std::size_t count = 1;
  const Type* at = &type;
  for (; at->kind == TypeKind::Array; at = at->element) {
    if (at->element == nullptr || at->count == 0) return 0;
    count *= at->count;  // cannot overflow: the array itself has a size
  }
  if (at->kind == TypeKind::Pointer) return 0;
  const auto known = sizes.find(at);
  return count * (known == sizes.end() ? at->size : known->second);
}

class FieldChecker {
 public:
  FieldChecker(const Type& type, const TypeSizes& sizes, std::vector<LayoutProblem>& problems)
      : type_(type), problems_(problems) {
    for (std::size_t i = 0; i < type.fields.size(); ++i) {
      if (type.fields[i].type == nullptr) continue;
      spans_.push_back({type.fields[i].offset, size_in_file(*type.fields[i].type, sizes), i});
    }
    std::ranges::stable_sort(spans_, {}, &Span::begin);
  }

  void check() {
    const Span* before = nullptr;
    for (const Span& span : spans_) {
      check_inside(span);
      if (before != nullptr && span.begin < before->begin + before->size) overlap(*before, span);
      if (before == nullptr || span.begin + span.size > before->begin + before->size) before = &span;
    }
  }

 private:
  struct Span {
    std::size_t begin = 0;
    std::size_t size = 0;
    std::size_t field = 0;
  };

  [[nodiscard]] std::string name(const Span& span) const { return quote(type_.fields[span.field].name); }

  void check_inside(const Span& span) {
    if (span.begin <= type_.size && span.size <= type_.size - span.begin) return;
    problems_.push_back({Severity::Error, "field-outside",
                         "field " + name(span) + " takes bytes " + std::to_string(span.begin) + " to " +
                             std::to_string(span.begin + span.size) + " of " + quote(type_.name) +
                             ", which has only " + std::to_string(type_.size),
                         &type_, span.field});
  }

  void overlap(const Span& first, const Span& second) {
    problems_.push_back({Severity::Warning, "fields-overlap",
                         "fields " + name(first) + " and " + name(second) + " of " + quote(type_.name) +
                             " share bytes from " + std::to_string(second.begin) +
                             " on: a union, or a layout of another machine",
                         &type_, second.field});
  }

  const Type& type_;
  std::vector<LayoutProblem>& problems_;
  std::vector<Span> spans_;
};

/// The types that lie within a type's own bytes, or that are marshalled in their place.
std::vector<const Type*> contents(const Type& type) {
  std::vector<const Type*> inside;
  if (type.kind == TypeKind::Container || type.kind == TypeKind::Pointer) return inside;
  for (const Field& field : type.fields)
    inside.push_back(field.type);
  if (type.element != nullptr) inside.push_back(type.element);
  return inside;
}

/// Walks depth first without recursion, each type once.
class NestingChecker {
 public:
  explicit NestingChecker(std::vector<LayoutProblem>& problems) : problems_(problems) {}

  void check(const Type& root) {
    enter(&root);
    while (!path_.empty()) {
      Step& step = path_.back();
      if (step.next == step.inside.size()) {
        leave();
        continue;
      }
      const Type* inside = step.inside[step.next++];
      if (inside == nullptr) continue;
      const auto seen = heights_.find(inside);
      if (seen == heights_.end()) {
        enter(inside);
      } else if (seen->second == kOnPath) {
        report(*step.type, "contains-itself",
               "type " + quote(inside->name) +
                   " contains itself; only a container or a pointer can hold its own kind");
      } else {
        step.height = std::max(step.height, seen->second + 1);
      }
    }
  }

 private:
  struct Step {
    const Type* type = nullptr;
    std::vector<const Type*> inside;
    std::size_t next = 0;
    std::size_t height = 0;
  };
  static constexpr std::size_t kOnPath = static_cast<std::size_t>(-1);

  void enter(const Type* type) {
    if (!heights_.try_emplace(type, kOnPath).second) return;
    path_.push_back({type, contents(*type), 0, 0});
  }

  void leave() {
    const Step step = std::move(path_.back());
    path_.pop_back();
    heights_[step.type] = step.height;
    if (step.height == kDeepestNesting + 1)
      report(*step.type, "too-deep",
             "type " + quote(step.type->name) + " nests more than " + std::to_string(kDeepestNesting) +
                 " types in each other");
    if (!path_.empty()) path_.back().height = std::max(path_.back().height, step.height + 1);
  }

  /// Reports a problem of the type itself, or of the type that declares an array of it.
  void report(const Type& found, std::string code, std::string message) {
    const auto declared = std::find_if(path_.rbegin(), path_.rend(),
                                       [](const Step& step) { return step.type->kind != TypeKind::Array; });
    const bool is_array = found.kind == TypeKind::Array && declared != path_.rend();
    const Type& type = is_array ? *declared->type : found;
    problems_.push_back({Severity::Error, std::move(code), std::move(message), &type, kNoField});
  }

  std::vector<LayoutProblem>& problems_;
  std::vector<Step> path_;
  std::unordered_map<const Type*, std::size_t> heights_;
};

}  // namespace

std::vector<LayoutProblem> check_layouts(std::span<const Type* const> types, const TypeSizes& sizes) {
  std::vector<LayoutProblem> problems;
  NestingChecker nesting(problems);
  for (const Type* type : types) {
    nesting.check(*type);
    if (type->kind == TypeKind::Compound) FieldChecker(*type, sizes, problems).check();
  }
  return problems;
}

}  // namespace segue::type::detail
