// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/type/describe.hpp>
#include <segue/type/type_info.hpp>
#include <segue/type/value.hpp>

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace segue::task {

class Component;

/// Options of a property, fixed when it is made.
struct PropertyOptions {
  bool live = false;  ///< may be set while the task is Stopped or Running; else in PreOperational only
  std::string doc{};
  /// Of a live property: called before it is set in Stopped, Running or RunTimeError, between updates, with
  /// the value as it was given (of a compound perhaps a part). A failure refuses it, and nothing is set.
  /// Applies the value elsewhere, such as in a device; on_configure does so before. (The setter of a dynamic
  /// property of oroGen.)
  std::function<Result<void>(const type::Value& value)> on_live_set{};
};

/// A named setting of a component. Set through its task only, between updates; hooks read it like a plain
/// variable.
class PropertyBase {
 public:
  PropertyBase(const PropertyBase&) = delete;
  PropertyBase& operator=(const PropertyBase&) = delete;
  virtual ~PropertyBase();

  [[nodiscard]] const std::string& name() const { return name_; }
  /// nullptr: any value; type_name() is then the declared name, or empty.
  [[nodiscard]] const type::TypeInfo* type() const { return type_; }
  [[nodiscard]] const std::string& type_name() const { return type_name_; }
  [[nodiscard]] bool live() const { return options_.live; }
  [[nodiscard]] const std::string& doc() const { return options_.doc; }
  /// PropertyOptions::on_live_set; empty: none.
  [[nodiscard]] const auto& on_live_set() const { return options_.on_live_set; }

  [[nodiscard]] virtual type::Value value() const = 0;
  [[nodiscard]] virtual type::Value default_value() const = 0;
  /// Whether a map sets only the fields that it names (compounds) instead of replacing the whole value.
  [[nodiscard]] virtual bool takes_parts() const { return true; }
  /// A checked value that is not in effect yet. apply() swaps it in and never fails.
  class Staged {
   public:
    virtual ~Staged() = default;
    virtual void apply() noexcept = 0;
  };
  /// Checks `value` (compounds may be partial, see takes_parts()) without changing the property. `path`
  /// begins the error message.
  virtual Result<std::unique_ptr<Staged>> stage(const type::Value& value, std::string_view path) = 0;

 protected:
  PropertyBase(Component& component, std::string name, const type::TypeInfo* type, std::string type_name,
               PropertyOptions options);

 private:
  Component& component_;
  std::string name_;
  std::string type_name_;
  PropertyOptions options_;
  const type::TypeInfo* type_;
};

/// A property of a C++ type. get() is a plain read: real-time safe in hooks, not for other threads.
template <class T>
class Property : public PropertyBase {
 public:
  Property(Component& component, std::string name, T default_value = T{}, PropertyOptions options = {})
      : PropertyBase(component, std::move(name), &type::type_info<T>(), {}, std::move(options)),
        default_(default_value),
        value_(std::move(default_value)) {}

  [[nodiscard]] const T& get() const noexcept { return value_; }
  const T& operator*() const noexcept { return value_; }
  const T* operator->() const noexcept { return &value_; }

  [[nodiscard]] type::Value value() const override { return type()->to_value(&value_); }
  [[nodiscard]] type::Value default_value() const override { return type()->to_value(&default_); }
  Result<std::unique_ptr<Staged>> stage(const type::Value& value, std::string_view path) override {
    auto staged = std::make_unique<StagedValue>(*this);
    auto read = type()->from_value(&staged->value, value, path);
    if (!read) return std::move(read.error());
    return std::unique_ptr<Staged>(std::move(staged));
  }

 private:
  struct StagedValue final : Staged {
    explicit StagedValue(Property& target) : property(target), value(target.value_) {}
    void apply() noexcept override { std::swap(property.value_, value); }
    Property& property;
    T value;
  };
  const T default_;
  T value_;
};

/// A property without a C++ type: holds any value that `check` accepts. For stand-ins. `is_compound` must be
/// set where its type is a compound.
class DynamicProperty final : public PropertyBase {
 public:
  using Check = std::function<Result<void>(const type::Value& value, std::string_view path)>;
  DynamicProperty(Component& component, std::string name, std::string type_name, type::Value default_value,
                  PropertyOptions options = {}, Check check = nullptr, bool is_compound = false);

  [[nodiscard]] type::Value value() const override { return value_; }
  [[nodiscard]] type::Value default_value() const override { return default_; }
  [[nodiscard]] bool takes_parts() const override { return is_compound_; }
  Result<std::unique_ptr<Staged>> stage(const type::Value& value, std::string_view path) override;

 private:
  type::Value default_;
  type::Value value_;
  Check check_;
  bool is_compound_;
};

}  // namespace segue::task
