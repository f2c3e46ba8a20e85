// SPDX-License-Identifier: Apache-2.0
#include <segue/type/cdr_parts.hpp>
#include <segue/type/described_type.hpp>
#include <segue/type/possible_types.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>

namespace segue::type::detail {
namespace {

using cdr::is_fixed_matrix;

/// Whether cdr_object.cpp supports the type itself, apart from its parts.
bool has_cdr(const DescribedType& described) {
  if (described.grid.number != nullptr) return true;
  switch (described.shape->type.kind) {
    case TypeKind::Numeric:
    case TypeKind::Enum:
      return std::has_single_bit(described.info.size) && described.info.size <= 8;
    case TypeKind::Compound:
    case TypeKind::Array:
      return described.conversion.to_value == nullptr;
    case TypeKind::Container:
      return has_items(described);
    default:
      return false;
  }
}

bool parts_have_cdr(const DescribedType& described) {
  if (described.grid.number != nullptr) return true;
  const Shape& shape = *described.shape;
  if (shape.element != nullptr) return shape.element->shape->cdr.possible;
  return std::ranges::all_of(shape.fields,
                             [](const DescribedField& field) { return field.type->shape->cdr.possible; });
}

/// The run that begins with the member `begin`.
CdrRun run_from(const Shape& shape, std::size_t begin) {
  const DescribedField& head = shape.fields[begin];
  CdrRun run{head.offset, 0, begin, 0, 1, 1, false};
  for (const DescribedField& field : std::span(shape.fields).subspan(begin)) {
    const CdrPlan& plan = field.type->shape->cdr;
    const bool adjacent = field.offset == run.offset + run.size;
    if (!plan.packed || !adjacent || (field.offset - run.offset) % plan.most != 0) break;
    if (run.count == 0) run.first = plan.first;
    run.size += field.type->info.size;
    run.most = std::max(run.most, plan.most);
    run.checked = run.checked || field.type->flat.checked;
    ++run.count;
  }
  return run;
}

void plan_compound(DescribedType& described) {
  Shape& shape = *described.shape;
  CdrPlan& plan = shape.cdr;
  for (std::size_t next = 0; next < shape.fields.size();) {
    plan.runs.push_back(run_from(shape, next));
    next += std::max<std::size_t>(plan.runs.back().count, 1);
  }
  if (plan.runs.size() != 1 || plan.runs.front().count == 0) return;
  const CdrRun& whole = plan.runs.front();
  // An array of the type can be copied as bytes only if each item begins where the alignment of the first one
  // requires.
  plan.packed = described.info.trivially_copyable && whole.offset == 0 && whole.size == described.info.size &&
                whole.size % whole.most == 0;
  plan.first = whole.first;
  plan.most = whole.most;
}

void plan_array(DescribedType& described) {
  const CdrPlan& element = described.shape->element->shape->cdr;
  CdrPlan& plan = described.shape->cdr;
  plan.packed = element.packed;
  plan.first = element.first;
  plan.most = element.most;
}

/// Parts are planned first; types contain themselves through containers only.
void plan_layout(DescribedType& described) {
  Shape& shape = *described.shape;
  if (!shape.cdr.possible || shape.cdr.planned || described.grid.number != nullptr) return;
  shape.cdr.planned = true;
  if (shape.type.kind == TypeKind::Numeric || shape.type.kind == TypeKind::Enum) {
    shape.cdr.packed = true;
    shape.cdr.first = shape.cdr.most = described.info.size;
  } else if (shape.type.kind == TypeKind::Array) {
    plan_layout(*shape.element);
    plan_array(described);
  } else if (shape.type.kind == TypeKind::Compound) {
    for (const DescribedField& field : shape.fields)
      plan_layout(*field.type);
    plan_compound(described);
  }
}

/// Containers may be empty, so the search ends at them.
std::size_t least_in_cdr(const DescribedType& described) {
  constexpr std::size_t kCount = 4;
  const Shape& shape = *described.shape;
  if (is_fixed_matrix(described)) return described.info.size;
  if (described.grid.number != nullptr) return 2 * sizeof(std::int64_t) + kCount;
  if (shape.type.kind == TypeKind::Container) return kCount;
  if (shape.type.kind == TypeKind::Array) return shape.type.count * least_in_cdr(*shape.element);
  if (shape.type.kind != TypeKind::Compound) return described.info.size;
  std::size_t least = shape.fields.empty() ? 1 : 0;
  for (const DescribedField& field : shape.fields)
    least += least_in_cdr(*field.type);
  return least;
}

}  // namespace

void plan_cdr(std::span<DescribedType* const> fresh) {
  find_possible(
      fresh, [](DescribedType& type) -> bool& { return type.shape->cdr.possible; }, has_cdr, parts_have_cdr);
  for (DescribedType* described : fresh)
    plan_layout(*described);
  for (DescribedType* described : fresh)
    described->shape->cdr.least = std::max<std::size_t>(least_in_cdr(*described), 1);
}

}  // namespace segue::type::detail
