// SPDX-License-Identifier: Apache-2.0
#include <segue/task/component.hpp>
#include <segue/task/property.hpp>

#include <algorithm>

namespace segue::task {

PropertyBase::PropertyBase(Component& component, std::string name, const type::TypeInfo* type,
                           std::string type_name, PropertyOptions options)
    : component_(component),
      name_(std::move(name)),
      type_name_(type == nullptr ? std::move(type_name) : std::string(type->name())),
      options_(std::move(options)),
      type_(type) {
  component_.properties_.push_back(this);
}

PropertyBase::~PropertyBase() {
  std::erase(component_.properties_, this);
}

DynamicProperty::DynamicProperty(Component& component, std::string name, std::string type_name,
                                 type::Value default_value, PropertyOptions options, Check check,
                                 bool is_compound)
    : PropertyBase(component, std::move(name), nullptr, std::move(type_name), std::move(options)),
      default_(default_value),
      value_(std::move(default_value)),
      check_(std::move(check)),
      is_compound_(is_compound) {}

Result<std::unique_ptr<PropertyBase::Staged>> DynamicProperty::stage(const type::Value& value,
                                                                     std::string_view path) {
  struct StagedValue final : Staged {
    StagedValue(type::Value& target, type::Value next) : property(target), staged(std::move(next)) {}
    void apply() noexcept override { std::swap(property, staged); }
    type::Value& property;
    type::Value staged;
  };
  if (check_) {
    if (auto fits = check_(value, path); !fits) return std::move(fits.error());
  }
  type::Value next = value;
  if (is_compound_) {
    next = value_;
    type::merge(next, value);
  }
  return std::unique_ptr<Staged>(std::make_unique<StagedValue>(value_, std::move(next)));
}

}  // namespace segue::task
